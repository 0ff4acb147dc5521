#pragma once

#include <optional>

#include "processing/base/shot.hpp"

namespace kolsky {

/// A shot's own "striker_speed_m_per_s" [m/s], else the bench's; nothing where none is filed.
/// @throws InputError where the shot's own is no speed
[[nodiscard]] std::optional<Measured> filed_striker_speed(const Shot& shot);

/// Of the striker's impedance in the bar's, for equal sections; nothing where it is not known. Of a
/// viscoelastic bar it depends on frequency but for a striker of the same material, which one
/// without a filed density is.
[[nodiscard]] std::optional<double> impedance_share(const Striker& striker, const Bar& bar);

}  // namespace kolsky

#pragma once

#include <cstddef>
#include <optional>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// A check, "drift", that warns where a gauge's readings move before the pulse, beyond doubt, and
/// by the histories' end would have moved by more than a hundredth of the gauge's largest reading
/// if they go on so: hum, an amplifier that has not settled, a gauge that warms up. The baseline is
/// the mean of the quiet part, so that is what every history is off by. Nothing where none does, or
/// fewer than 64 samples are quiet.
/// @param quiet  samples before the pulse
/// @param end    of what the histories are taken from, in samples
[[nodiscard]] std::optional<Check> quiet_drift(const Shot& shot, std::size_t quiet,
                                               std::size_t end);

}  // namespace kolsky

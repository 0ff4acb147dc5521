#pragma once

#include <optional>
#include <span>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"
#include "processing/reduction/stations.hpp"

namespace kolsky {

/// A check that fails, "specimen_strain", where the loading shortens a specimen by its whole length
/// or more; nothing where it does not. A specimen that is pulled may well grow by as much.
[[nodiscard]] std::optional<Check> impossible_specimen_strain(const Reduction& reduction);

/// A check that fails, "bar_strain", where a bar would be strained as none bears: elastic ones
/// beyond 2 %, viscoelastic ones beyond 10 %; nothing where it is not.
/// @param strain  of the station, the whole record
[[nodiscard]] std::optional<Check> impossible_bar_strain(const Shot& shot,
                                                         const BarStation& station,
                                                         std::span<const double> strain);

/// A check, "striker_speed", that warns where the incident pulse is over twice or under half of
/// what the striker's filed speed V makes of it: V / c r / (1 + r), r the striker's impedance in
/// the bar's (V / 2c for a striker of the bar's material and section). Nothing where speed, section
/// or impedance is not known.
/// @param peak_strain        largest of the incident pulse at its gauge
/// @param wave_speed_m_per_s of a front in the input bar
[[nodiscard]] std::optional<Check> striker_speed(const Shot& shot, const BarStation& station,
                                                 double peak_strain, double wave_speed_m_per_s);

}  // namespace kolsky

#pragma once

#include <span>
#include <vector>

#include "processing/waves/bar_modes.hpp"

namespace kolsky {

/// By how much longer than elementary waves the slowest group takes [s/m] of all up to each bin of
/// a path: the largest d/dw Im(gamma - s sqrt(rho J)) so far, and at most what slowest_over_front
/// allows. Elementary waves are all told a front's travel after they passed; what lateral inertia
/// slows is under way for longer. Empty for elementary waves.
[[nodiscard]] std::vector<double> lateral_delay_s_per_m(WaveTheory theory, const Bar& bar,
                                                        const Compliance& compliance,
                                                        std::span<const BarMode> modes,
                                                        const std::vector<Complex>& path);

/// Of all that a band's filter lets through.
/// @param delay_s_per_m  by bin of that path
[[nodiscard]] double lateral_delay_within(std::span<const double> delay_s_per_m,
                                          std::span<const Complex> path, double band_limit_Hz);

}  // namespace kolsky

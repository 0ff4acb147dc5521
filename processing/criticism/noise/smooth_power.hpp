#pragma once

#include <vector>

namespace kolsky {

/// The smooth spectrum s0 + s1/f + s2/f^2, s >= 0, f = 1, 2, ..., most likely to have given these
/// powers (Whittle's likelihood: each is the spectrum times a chi-square variable over its degrees
/// of freedom).
[[nodiscard]] std::vector<double> smooth_power(const std::vector<double>& power);

}  // namespace kolsky

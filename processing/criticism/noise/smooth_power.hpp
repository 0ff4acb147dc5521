#pragma once

#include <vector>

namespace kolsky {

/// A smooth spectrum s0 + s1/f + s2/f^2, s >= 0.
struct SmoothPower {
  double white = 0.0;
  double pink = 0.0;
  double walk = 0.0;  ///< as of a random walk

  [[nodiscard]] double at(double f) const { return white + pink / f + walk / (f * f); }
};

/// The smooth spectrum most likely to have given these powers at f = 1, 2, ... (Whittle's
/// likelihood: each is the spectrum times a chi-square variable over its degrees of freedom).
[[nodiscard]] SmoothPower smooth_power(const std::vector<double>& power);

}  // namespace kolsky

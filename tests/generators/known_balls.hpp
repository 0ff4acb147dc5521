#pragma once

#include <cstddef>

namespace kolsky::testing {

/// A free elastic sphere of 42.7 mm, E 100 MPa, 1100 kg/m3, nu 0.3: xi cot xi = 1 - (xi cp/(2
/// cs))^2 has xi = 2.67021.
inline constexpr double kBreathing_Hz = 6963.37;

/// Frequency of the mode in which it breathes as a whole, by processing/impact's elements.
[[nodiscard]] double breathing_frequency_Hz(std::size_t elements);

struct HertzRun {
  double patch;    // largest contact radius over the ball's, by Hertz
  double ratio;    // contact time over Hertz's
  double peak;     // largest force over Hertz's
  double radius;   // largest contact radius over Hertz's
  double impulse;  // over 2 m V
};

/// The same sphere on a rigid wall, without friction. Hertz: delta = (5 m V^2 / 4 k)^0.4, k = 4/3
/// E* sqrt(R), T = 2.943 delta/V; he has small patches, and T/T_H = 1 - 0.29 a/R.
[[nodiscard]] HertzRun hertz(double speed_m_per_s, std::size_t elements);

}  // namespace kolsky::testing

#pragma once

#include <cmath>

namespace kolsky {

/// A number of the apparatus or of a material, with the standard deviation filed beside it. The
/// unit is in the name of whatever holds it. sd == 0 means the number counts as exact.
struct Measured {
  double value = 0.0;
  double sd = 0.0;

  // Implicit on purpose: formulas read as in the paper, and the deviation is asked for by name.
  operator double() const noexcept { return value; }  // NOLINT(google-explicit-constructor)
};

/// 0 for a number without a deviation, or a number that is 0.
[[nodiscard]] inline double relative_sd(const Measured& number) {
  return number.value != 0.0 ? number.sd / std::abs(number.value) : 0.0;
}

}  // namespace kolsky

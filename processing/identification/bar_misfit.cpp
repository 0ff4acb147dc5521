#include "processing/identification/bar_misfit.hpp"

#include <cmath>

namespace kolsky {

namespace {

/// Exceeded once in ten thousand times, for some ten octaves.
constexpr double kBeyondChance = 3.7;

}  // namespace

double OctaveLeft::apart(std::size_t shots) const {
  const auto count = static_cast<double>(shots);
  return (count * of_all - in_common) / (count - 1.0);
}

double normal_of_variance_ratio(double ratio, double above, double below) {
  const double a = 2.0 / (9.0 * above);
  const double b = 2.0 / (9.0 * below);
  const double root = std::cbrt(ratio);
  return ((1.0 - b) * root - (1.0 - a)) / std::sqrt(b * root * root + a);
}

std::optional<CommonMisfit> common_misfit(const std::vector<OctaveLeft>& left, std::size_t shots) {
  std::optional<CommonMisfit> worst;
  if (shots < 2) {
    return worst;
  }
  for (const OctaveLeft& octave : left) {
    const double power = octave.in_common / octave.apart(shots);
    const double deviations = normal_of_variance_ratio(
        power, octave.count_as, octave.count_as * (static_cast<double>(shots) - 1.0));
    if (deviations > kBeyondChance && (!worst || deviations > worst->deviations)) {
      worst = CommonMisfit{octave.low_Hz, octave.high_Hz, power, deviations};
    }
  }
  return worst;
}

}  // namespace kolsky

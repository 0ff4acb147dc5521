#include "processing/identification/bar_misfit.hpp"

#include <cmath>

namespace kolsky {

namespace {

/// Exceeded once in ten thousand times, for some ten octaves.
constexpr double kBeyondChance = 3.7;

double in_common_over_apart(const OctaveLeft& octave, std::size_t shots) {
  return octave.in_common / octave.apart(shots);
}

double deviations_of(const OctaveLeft& octave, std::size_t shots) {
  return normal_of_variance_ratio(in_common_over_apart(octave, shots), octave.count_as,
                                  octave.count_as * (static_cast<double>(shots) - 1.0));
}

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

bool beyond_chance(const OctaveLeft& octave, std::size_t shots) {
  return shots > 1 && deviations_of(octave, shots) > kBeyondChance;
}

std::optional<CommonMisfit> common_misfit(const std::vector<OctaveLeft>& left, std::size_t shots) {
  std::optional<CommonMisfit> worst;
  for (const OctaveLeft& octave : left) {
    if (!beyond_chance(octave, shots)) {
      continue;
    }
    const double deviations = deviations_of(octave, shots);
    if (!worst || deviations > worst->deviations) {
      worst = CommonMisfit{octave.low_Hz, octave.high_Hz, in_common_over_apart(octave, shots),
                           deviations};
    }
  }
  return worst;
}

}  // namespace kolsky

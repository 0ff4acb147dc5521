#pragma once

#include <string>
#include <vector>

namespace kolsky {

/// Between these shares of the draws lies the 95 % interval.
inline constexpr double kLow = 0.025;
inline constexpr double kHigh = 0.975;
/// And as far does it reach from the middle of a normal distribution.
inline constexpr double kDeviationsOf95 = 1.96;

/// The p-quantile of values, which it reorders; at least one.
[[nodiscard]] double quantile(std::vector<double>& values, double p);

/// Of at least one.
[[nodiscard]] double mean_of(const std::vector<double>& values);

/// The values' standard deviation; 0 for fewer than two.
[[nodiscard]] double sd_of(const std::vector<double>& values);

/// One number, and what draws make of it.
struct UncertainFigure {
  std::string name;  ///< with its unit: "peak_stress_Pa"
  double value = 0.0;
  double sd = 0.0;
  double low = 0.0;  ///< of the 95 % interval
  double high = 0.0;
  /// By how much noise makes it larger than it is: of the largest of noisy samples alone.
  double lifted_by_noise = 0.0;
};

/// Of the largest of noisy samples, which noise lifts: draws add noise to what it has lifted
/// already. On a flat top the lift goes with the noise's rms, so what draws add is sqrt(2) - 1 of
/// what the shot's own noise added; where a top is rounded it is less than that. The interval then
/// reaches 1.96 deviations below the value without that lift (extrapolation to no noise, as
/// simulation-extrapolation does).
/// @param noisier  the figure in draws of noise alone, at least one
void free_of_noise_added(UncertainFigure& figure, const std::vector<double>& noisier);

/// @param draws  its values in the draws, at least one
[[nodiscard]] UncertainFigure uncertain_figure(std::string name, double value,
                                               std::vector<double> draws);

}  // namespace kolsky

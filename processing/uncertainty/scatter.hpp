#pragma once

#include <string>
#include <vector>

namespace kolsky {

/// Between these shares of the draws lies the 95 % interval.
inline constexpr double kLow = 0.025;
inline constexpr double kHigh = 0.975;

/// The p-quantile of values, which it reorders; at least one.
[[nodiscard]] double quantile(std::vector<double>& values, double p);

/// The values' standard deviation; 0 for fewer than two.
[[nodiscard]] double sd_of(const std::vector<double>& values);

/// One number, and what draws make of it.
struct UncertainFigure {
  std::string name;  ///< with its unit: "peak_stress_Pa"
  double value = 0.0;
  double sd = 0.0;
  double low = 0.0;  ///< of the 95 % interval
  double high = 0.0;
};

/// Of the largest of noisy samples: what noise adds to it in the draws, the shot's own noise has
/// added to it already, so that the truth may lie as far below it. The interval then goes at least
/// as far towards zero as the draws go away from it.
void reach_as_far_down(UncertainFigure& figure);

/// @param draws  its values in the draws, at least one
[[nodiscard]] UncertainFigure uncertain_figure(std::string name, double value,
                                               std::vector<double> draws);

}  // namespace kolsky

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

/// @param draws  its values in the draws, at least one
[[nodiscard]] UncertainFigure uncertain_figure(std::string name, double value,
                                               std::vector<double> draws);

}  // namespace kolsky

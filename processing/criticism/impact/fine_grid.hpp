#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "processing/criticism/impact/ball_runs.hpp"

namespace kolsky {

/// What gauges read of a calculated impact is laid out kRunStep_s apart, from so long before the
/// first touch on.
constexpr double kFineGridLead_s = 150e-6;

/// Third-order interpolation between samples, and its derivative.
struct Interpolated {
  double value = 0.0;
  double slope_per_s = 0.0;
};

/// @param place  in samples
[[nodiscard]] inline Interpolated between_samples(const std::vector<double>& values, double place,
                                                  double period_s) {
  const auto last = static_cast<double>(values.size()) - 3.0;
  const double held = std::clamp(place, 1.0, last);
  const auto n = static_cast<std::size_t>(held);
  const double u = held - static_cast<double>(n);
  const double a = values[n - 1];
  const double b = values[n];
  const double c = values[n + 1];
  const double d = values[n + 2];
  const double c1 = c - a / 3.0 - b / 2.0 - d / 6.0;
  const double c2 = (a + c) / 2.0 - b;
  const double c3 = (d - a) / 6.0 + (b - c) / 2.0;
  return {b + u * (c1 + u * (c2 + u * c3)), (c1 + u * (2.0 * c2 + 3.0 * u * c3)) / period_s};
}

[[nodiscard]] inline Interpolated on_fine_grid(const std::vector<double>& grid, double time_s) {
  return between_samples(grid, (time_s + kFineGridLead_s) / kRunStep_s, kRunStep_s);
}

}  // namespace kolsky

#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "processing/criticism/ball_runs.hpp"

namespace kolsky {

/// What gauges read of a calculated impact is laid out kRunStep_s apart, from so long before the
/// first touch on.
constexpr double kFineGridLead_s = 150e-6;

/// Third-order interpolation on the fine grid and its derivative by time.
struct Interpolated {
  double value = 0.0;
  double slope_per_s = 0.0;
};

[[nodiscard]] inline Interpolated on_fine_grid(const std::vector<double>& grid, double time_s) {
  const double place = (time_s + kFineGridLead_s) / kRunStep_s;
  const auto last = static_cast<double>(grid.size()) - 3.0;
  const double held = std::clamp(place, 1.0, last);
  const auto n = static_cast<std::size_t>(held);
  const double u = held - static_cast<double>(n);
  const double a = grid[n - 1];
  const double b = grid[n];
  const double c = grid[n + 1];
  const double d = grid[n + 2];
  const double c1 = c - a / 3.0 - b / 2.0 - d / 6.0;
  const double c2 = (a + c) / 2.0 - b;
  const double c3 = (d - a) / 6.0 + (b - c) / 2.0;
  return {b + u * (c1 + u * (c2 + u * c3)), (c1 + u * (2.0 * c2 + 3.0 * u * c3)) / kRunStep_s};
}

}  // namespace kolsky

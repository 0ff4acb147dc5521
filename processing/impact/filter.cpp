#include "processing/impact/filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace kolsky::impact {

std::vector<double> low_passed(std::span<const double> values, double interval_s,
                               double cutoff_Hz) {
  const double sigma =
      std::sqrt(std::numbers::ln2) / (2.0 * std::numbers::pi * cutoff_Hz) / interval_s;
  const auto reach = static_cast<std::ptrdiff_t>(std::ceil(4.0 * sigma));
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  std::vector<double> weight(static_cast<std::size_t>(reach) + 1);
  for (std::size_t k = 0; k < weight.size(); ++k) {
    const double distance = static_cast<double>(k) / sigma;
    weight[k] = std::exp(-0.5 * distance * distance);
  }
  std::vector<double> result(values.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    double sum = 0.0;
    double weights = 0.0;
    for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, i - reach);
         k <= std::min(count - 1, i + reach); ++k) {
      const double own = weight[static_cast<std::size_t>(std::abs(k - i))];
      sum += own * values[static_cast<std::size_t>(k)];
      weights += own;
    }
    result[static_cast<std::size_t>(i)] = sum / weights;
  }
  return result;
}

std::vector<double> mean_rate(std::span<const double> values, double interval_s, double window_s) {
  const auto half =
      static_cast<std::ptrdiff_t>(std::max<long>(1, std::lround(0.5 * window_s / interval_s)));
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  std::vector<double> rate(values.size(), 0.0);
  for (std::ptrdiff_t i = 0; count > 1 && i < count; ++i) {
    const std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, i - half);
    const std::ptrdiff_t to = std::min(count - 1, i + half);
    rate[static_cast<std::size_t>(i)] =
        (values[static_cast<std::size_t>(to)] - values[static_cast<std::size_t>(from)]) /
        (interval_s * static_cast<double>(to - from));
  }
  return rate;
}

}  // namespace kolsky::impact

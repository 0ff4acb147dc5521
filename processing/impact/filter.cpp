#include "processing/impact/filter.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <span>

namespace kolsky::impact {

namespace {

constexpr double kSameInterval = 1e-9;  // relative

bool same_interval(double interval_s, double wanted_s) {
  return std::abs(wanted_s / interval_s - 1.0) < kSameInterval;
}

// The last interval begins before the last known one ends.
std::size_t samples_at(std::size_t known, double interval_s, double wanted_s) {
  const double end_s = (static_cast<double>(known) - 0.5) * interval_s;
  return static_cast<std::size_t>(std::ceil(end_s / wanted_s + 0.5));
}

double between(std::span<const double> values, double place) {
  const double last = static_cast<double>(values.size()) - 1.0;
  if (place >= last) {
    return values.back();
  }
  const auto n = static_cast<std::size_t>(std::max(0.0, place));
  const double share = std::max(0.0, place) - static_cast<double>(n);
  return (1.0 - share) * values[n] + share * values[n + 1];
}

}  // namespace

std::vector<double> means_at(std::span<const double> means, double interval_s, double wanted_s) {
  if (means.empty() || same_interval(interval_s, wanted_s)) {
    return {means.begin(), means.end()};
  }
  // Sums up to the edges between intervals: at 0, 1/2, 3/2, ...
  std::vector<double> sums{0.0};
  for (const double mean : means) {
    sums.push_back(sums.back() + mean * interval_s);
  }
  const auto sum_to = [&](double time_s) {
    const double place = time_s / interval_s;
    return place < 0.5 ? sums[1] * std::max(0.0, 2.0 * place) : between(sums, place + 0.5);
  };
  std::vector<double> result(samples_at(means.size(), interval_s, wanted_s));
  for (std::size_t n = 0; n < result.size(); ++n) {
    const double middle_s = static_cast<double>(n) * wanted_s;
    result[n] = (sum_to(middle_s + 0.5 * wanted_s) - sum_to(middle_s - 0.5 * wanted_s)) / wanted_s;
  }
  return result;
}

std::vector<double> values_at(std::span<const double> values, double interval_s, double wanted_s) {
  if (values.empty() || same_interval(interval_s, wanted_s)) {
    return {values.begin(), values.end()};
  }
  std::vector<double> result(samples_at(values.size(), interval_s, wanted_s));
  for (std::size_t n = 0; n < result.size(); ++n) {
    result[n] = between(values, static_cast<double>(n) * wanted_s / interval_s);
  }
  return result;
}

double low_pass_sigma_s(double cutoff_Hz) {
  return std::sqrt(std::numbers::ln2) / (2.0 * std::numbers::pi * cutoff_Hz);
}

std::vector<double> low_passed(std::span<const double> values, double interval_s,
                               double cutoff_Hz) {
  const double sigma = low_pass_sigma_s(cutoff_Hz) / interval_s;
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

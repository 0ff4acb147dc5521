#include "processing/uncertainty/converter_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "processing/reduction/pulse.hpp"

namespace kolsky {

namespace {

/// Of a step: less is below every noise that a shot has.
constexpr double kNothing = 1e-3;

double smallest_distance(std::span<const std::int32_t> codes) {
  std::vector<std::int32_t> values(codes.begin(), codes.end());
  std::ranges::sort(values);
  double smallest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < values.size(); ++n) {
    const double distance = static_cast<double>(values[n]) - static_cast<double>(values[n - 1]);
    smallest = distance > 0.0 ? std::min(smallest, distance) : smallest;
  }
  return std::isfinite(smallest) ? smallest : 0.0;
}

double uniform(RandomStream& random) {
  constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
  return (static_cast<double>(random.next() >> 11U) + 0.5) * kUnit - 0.5;
}

}  // namespace

ConverterSteps::ConverterSteps(std::span<const std::int32_t> codes, std::size_t quiet)
    : quiet_(std::min(quiet, codes.size())), step_(smallest_distance(codes)) {
  if (step_ == 0.0) {
    return;
  }
  const std::vector<double> before(codes.begin(),
                                   codes.begin() + static_cast<std::ptrdiff_t>(quiet_));
  const double rms = quiet_before(before, before.size()).noise_rms / step_;
  const double variance = std::max(0.0, rms * rms - 1.0 / 12.0);
  undithered_ = std::exp(-2.0 * std::pow(std::numbers::pi, 2) * variance);
  for (std::size_t n = quiet_; n < codes.size();) {
    std::size_t end = n + 1;
    while (end < codes.size() && codes[end] == codes[n]) {
      ++end;
    }
    const bool inside = n > 0 && end < codes.size();
    const bool passing =
        inside && (codes[n - 1] < codes[n]) == (codes[n] < codes[end]) && codes[n - 1] != codes[n];
    runs_.push_back({n, end, passing});
    n = end;
  }
}

bool ConverterSteps::matters() const {
  return undithered_ > kNothing;
}

void ConverterSteps::add(RandomStream& random, std::vector<double>& values) const {
  const double most = step_ * undithered_;
  // All that counts of the baseline is how far it lies off the samples behind it.
  const double baseline = most * uniform(random);
  for (const Run& run : runs_) {
    // Passing through a step is off to both sides in turn, standing on it is off to one.
    double off = most * uniform(random);
    for (std::size_t n = run.begin; n < run.end; ++n) {
      values[n] += baseline + off;
      off = run.passing ? most * uniform(random) : off;
    }
  }
}

}  // namespace kolsky

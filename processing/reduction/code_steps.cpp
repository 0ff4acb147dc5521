#include "processing/reduction/code_steps.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

namespace kolsky {

namespace {

/// A record's values, each once, in order; none where they are more than so many.
std::vector<double> values_of(std::span<const double> record, std::size_t most) {
  // By its bits a value has a place in a table, or the next that is free: half of them stay so.
  const auto bits = static_cast<int>(std::bit_width(2 * most + 1));
  std::vector<std::uint32_t> known(std::size_t{1} << bits);  // 1 + the index of a value, or 0
  std::vector<double> values;
  for (const double value : record) {
    const double signless_zero = value + 0.0;
    std::size_t place =
        (std::bit_cast<std::uint64_t>(signless_zero) * 0x9e3779b97f4a7c15U) >> (64 - bits);
    while (known[place] != 0 && values[known[place] - 1] != value) {
      place = (place + 1) % known.size();
    }
    if (known[place] == 0) {
      if (values.size() == most) {
        return {};
      }
      values.push_back(value);
      known[place] = static_cast<std::uint32_t>(values.size());
    }
  }
  std::sort(values.begin(), values.end());
  return values;
}

}  // namespace

double least_step(std::span<const double> readings) {
  std::vector<double> sorted(readings.begin(), readings.end());
  std::ranges::sort(sorted);
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t n = 1; n < sorted.size(); ++n) {
    const double step = sorted[n] - sorted[n - 1];
    least = step > 0.0 ? std::min(least, step) : least;
  }
  return least;
}

std::vector<double> code_steps(std::span<const double> readings) {
  constexpr std::size_t kSamplesPerValue = 4;
  const std::vector<double> values = values_of(readings, readings.size() / kSamplesPerValue);
  if (values.size() < 3) {
    return {};
  }
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) {
    steps.push_back(values[i] - values[i - 1]);
  }
  std::ranges::sort(steps);
  return steps;
}

double code_step(std::span<const double> readings) {
  const std::vector<double> steps = code_steps(readings);
  return steps.empty() ? 0.0 : steps[steps.size() / 4];
}

}  // namespace kolsky

#include "drivers/files/tables/quantise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kolsky {

namespace {

constexpr double kLargestCode = std::numeric_limits<std::int32_t>::max() - 1;

double scale_for(double largest) {
  int exponent = 0;
  (void)std::frexp(largest, &exponent);  // largest < 2^exponent
  const double scale =
      std::ldexp(1.0, std::max(exponent - 31, std::numeric_limits<double>::min_exponent));
  return std::round(largest / scale) > kLargestCode ? 2.0 * scale : scale;
}

}  // namespace

QuantisedValues quantise(std::span<const double> values, double full_scale) {
  double largest = full_scale;
  for (const double value : values) {
    largest = std::max(largest, std::abs(value));
  }
  QuantisedValues result;
  result.scale = scale_for(largest);
  result.codes.reserve(values.size());
  for (const double value : values) {
    result.codes.push_back(static_cast<std::int32_t>(std::lround(value / result.scale)));
  }
  return result;
}

}  // namespace kolsky

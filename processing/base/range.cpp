#include "processing/base/range.hpp"

#include <array>
#include <cmath>
#include <cstdio>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

void require(const std::string& place, double tested, const Measured& number, const Range& range) {
  if (!(tested >= range.least && tested <= range.most)) {
    throw InputError(place,
                     in_words(number.value, range.unit) + " is outside " +
                         in_words(range.least, "") + " to " + in_words(range.most, range.unit),
                     range.mend);
  }
  if (!(number.sd >= 0.0) || !std::isfinite(number.sd)) {
    throw InputError(place + "_sd", in_words(number.sd, range.unit) + " is no standard deviation",
                     "give a finite number of at least 0");
  }
}

}  // namespace

void require_in_range(const std::string& place, const Measured& number, const Range& range) {
  require(place, number.value, number, range);
}

void require_magnitude_in_range(const std::string& place, const Measured& number,
                                const Range& range) {
  require(place, std::abs(number.value), number, range);
}

std::string in_words(double value, const std::string& unit) {
  std::array<char, 32> digits{};
  (void)std::snprintf(digits.data(), digits.size(), "%.6g", value);
  return unit.empty() ? std::string(digits.data()) : std::string(digits.data()) + " " + unit;
}

}  // namespace kolsky

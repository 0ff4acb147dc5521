#pragma once

#include <string>

#include "processing/base/measured.hpp"

namespace kolsky {

/// What a number of the apparatus can sensibly be. The bounds are wide enough for any bench and
/// narrow enough that the same number in a neighbouring unit falls outside.
struct Range {
  double least;
  double most;
  const char* unit;  ///< "m"
  const char* mend;  ///< "give metres: 15 mm is 0.015"
};

namespace ranges {
inline constexpr Range kDensity{25.0, 25e3, "kg/m3", "give kg/m3: 1.18 g/cm3 is 1180"};
inline constexpr Range kPoissonRatio{0.0, 0.5, "", "give a ratio: 36 % is 0.36"};
}  // namespace ranges

/// @throws InputError at `place` unless least <= value <= most and the deviation is finite and not
///   negative
void require_in_range(const std::string& place, const Measured& number, const Range& range);

/// The same for the number's magnitude, where its sign says how something is connected.
void require_magnitude_in_range(const std::string& place, const Measured& number,
                                const Range& range);

/// A number for people: six digits and its unit.
[[nodiscard]] std::string in_words(double value, const std::string& unit);

}  // namespace kolsky

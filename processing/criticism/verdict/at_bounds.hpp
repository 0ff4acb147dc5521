#pragma once

#include <string>
#include <vector>

#include "processing/models/model.hpp"

namespace kolsky {

/// A number that a fit moved to the end of what it may be. What the records ask for may lie beyond,
/// and deviations of the numbers beside it hold for that end only.
struct AtBound {
  std::string effect;  ///< "specimen-second-relaxation"
  std::string parameter;
  double value = 0.0;
  std::string unit;
  bool most = false;       ///< else least
  bool auxiliary = false;  ///< no strength: a relaxation's time
};

/// Of a fitted model; a strength of null is no bound to speak of.
[[nodiscard]] std::vector<AtBound> numbers_at_bounds(const Model& fitted);

/// In a sentence.
[[nodiscard]] std::string in_words(const AtBound& number);

}  // namespace kolsky

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// A claim that a specimen which departs from its law does as well as.
struct OtherLaw {
  std::string law;    ///< what is claimed of it
  std::string claim;  ///< what a departure cannot be told from
  Studied without;    ///< the fit that lacks this
};

/// Where a claim is of the specimen's law, a second may be what the specimen departs from that law
/// by: it softens as it warms, levels off, does not come back, which no effect of the library is.
/// @param current  fitted with what is claimed, to first order beside which a departure is held
///                 against every claim that is neither of that law nor what a formula gives
/// @return the first claim that a departure cannot be told from; nothing where none can
[[nodiscard]] std::optional<OtherLaw> other_law_in_place_of(
    Study& study, const Studied& current, const std::vector<std::string>& effects);
/// In a sentence.
[[nodiscard]] std::string other_law_text(const OtherLaw& other);

}  // namespace kolsky

#pragma once

#include <string>
#include <vector>

#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

/// An effect that changes nothing at first and much later, as an offset does until the patch comes
/// to the bar's edge: it has no slope at none, and a search that begins there passes it over.
struct FlatEffect {
  std::string id;
  std::string unit;
  double not_excluded = 0.0;  ///< largest strength that the records do not speak against
  double nearest = 0.0;       ///< strength that fits best; 0: none
  double gain = 0.0;          ///< of the objective there
};

/// How candidates that first order does not see fare at finite strengths beside a fitted model, its
/// own numbers moved to first order.
/// @param untested  ids of those
/// @param excluded  gain of the objective by which one thing stands before another
/// @return those that would show at their largest strength
[[nodiscard]] std::vector<FlatEffect> flat_effects(ImpactStudy& study, const Studied& studied,
                                                   const std::vector<std::string>& untested,
                                                   double excluded);

}  // namespace kolsky

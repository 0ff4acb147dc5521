#pragma once

#include <optional>
#include <string>

#include "processing/identification/bar_identification.hpp"

namespace kolsky {

/// A family of solids that the records prefer to the three elements by which reductions carry
/// waves, and which a material file holds, too.
struct BetterSolid {
  SolidKind solid = SolidKind::three_element;
  double log_evidence_ahead = 0.0;
  double chi2_reduced = 0.0;  ///< what it leaves
};

/// The one furthest ahead under the same waves and far end; none by less than a log evidence of 10.
[[nodiscard]] std::optional<BetterSolid> better_solid(const BarIdentification& result);

/// What it costs to go on with three elements, in one sentence.
[[nodiscard]] std::string cost_of_three_elements(const BetterSolid& better,
                                                 const BarFit& three_element);

}  // namespace kolsky

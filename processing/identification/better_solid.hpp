#pragma once

#include <optional>
#include <string>

#include "processing/identification/bar_identification.hpp"

namespace kolsky {

/// What a material file takes: the solid that was asked for or that the evidence chose, three
/// elements with what their choice of waves leaves open in their deviations.
[[nodiscard]] const BarFit& fit_to_file(const BarIdentification& result);

/// The same as a bar model: what a material file holds, and what specimens between such bars go by.
/// @param source  where it comes from, for people
[[nodiscard]] Material material_to_file(const BarIdentification& result, const Bar& bar,
                                        std::string source);

/// By so much in log evidence another family has to be ahead to be named.
inline constexpr double kClearlyAhead = 10.0;

/// A family of solids that the records prefer to the one that is to be filed.
struct BetterSolid {
  SolidKind solid = SolidKind::three_element;
  double log_evidence_ahead = 0.0;
  double chi2_reduced = 0.0;  ///< what it leaves
};

/// The one furthest ahead under the same waves and far end; none by less than `kClearlyAhead`.
[[nodiscard]] std::optional<BetterSolid> better_solid(const BarIdentification& result);

/// What it costs to go on with the one that is to be filed, in one sentence.
[[nodiscard]] std::string cost_of_going_by(const BarFit& filed, const BetterSolid& better);
/// The same with what files the better one.
[[nodiscard]] std::string cost_of_filing(const BarFit& filed, const BetterSolid& better);

}  // namespace kolsky

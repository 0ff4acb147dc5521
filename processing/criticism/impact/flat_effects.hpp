#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/search/candidate_table.hpp"

namespace kolsky {

/// An effect that changes nothing at first and much later, as an offset does until the patch comes
/// to the bar's edge: it has no slope at none, and derivatives there pass it over. So it is tried
/// at finite strengths beside a fitted model, whose own numbers move to first order.
struct FlatEffect {
  std::string id;
  std::string unit;
  /// Rising strengths, and what each changes of the residuals clear of what the model's numbers
  /// take up: a sum of squares of normal deviates. The first is none.
  std::vector<double> strengths{0.0};
  std::vector<double> squares{0.0};
  std::vector<double> gains{0.0};  ///< of the objective
  /// As if it were linear from none to where it fits best (or, where it nowhere gains, to where it
  /// is the first to show): what a search goes by in place of derivatives.
  Direction secant;

  /// Strength that fits best; 0: none.
  [[nodiscard]] double nearest() const;
  [[nodiscard]] double gain() const;  ///< there
  /// Largest strength that the records do not speak against.
  /// @param excluded  gain by which one thing stands before another
  [[nodiscard]] double not_excluded(double excluded) const;
  /// Strength that changes so much; infinite beyond the largest.
  [[nodiscard]] double showing(double squares_wanted) const;
};

/// @param shows  sum of squares from which on it can be told from none
/// @return none where the candidate is of another kind (several strengths, one that is filed) or
/// shows at no strength
[[nodiscard]] std::optional<FlatEffect> flat_effect(ImpactStudy& study, const Studied& studied,
                                                    const Candidate& candidate, double shows,
                                                    std::size_t worker);

/// Rows of a table that was made with their secants: what is detectable, and told apart from the
/// nearest rival, is where what they change grows to as much.
/// @param scale  what a square of a normal deviate counts over
void set_limits(const std::vector<FlatEffect>& flat, double scale,
                std::vector<CandidateResult>& table);

}  // namespace kolsky

#pragma once

#include <vector>

#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// What one search starts from: a fitted model, whatever it may lack, and what first order says of
/// that.
struct SearchGround {
  Study& study;
  const Studied& base;  ///< the model as fitted
  std::vector<Candidate> candidates;
  std::vector<Direction> directions;  ///< of the candidates, one each
  bool may_be_astray = false;         ///< the model as fitted

  /// @param fitted  outlives this
  SearchGround(Study& of, const Studied& fitted);

  /// Whether the model is so far from the records that first order says little.
  [[nodiscard]] bool far_off() const;
  /// First order's for a candidate, as a square of a normal deviate.
  [[nodiscard]] double evidence_of(std::size_t candidate) const;
};

/// Evidence by which a candidate is worth a refit.
inline constexpr double kWorthRefitting = 12.0;

}  // namespace kolsky

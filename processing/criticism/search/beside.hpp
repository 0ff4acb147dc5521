#pragma once

#include <Eigen/Core>

#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// How much of a candidate's gain is left, to first order, with another in the model: 0 to 1; 0
/// where a strength changes its sign beside it.
/// @param covariance  of the model's own numbers
[[nodiscard]] double share_beside(const Direction& own, const Candidate& other,
                                  const Direction& of_other, const Eigen::MatrixXd& covariance);

}  // namespace kolsky

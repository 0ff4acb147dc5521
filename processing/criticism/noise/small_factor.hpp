#pragma once

#include <Eigen/Core>

namespace kolsky {

/// Puts the inverse of its lower Cholesky factor in the place of a Hermitian matrix of a few rows,
/// of which the lower half is read.
/// @return false where the matrix is not positive definite: then it holds nothing
[[nodiscard]] bool invert_factor(Eigen::MatrixXcd& matrix);

}  // namespace kolsky

#pragma once

#include <Eigen/Core>

namespace kolsky {

// Decompositions of matrices of any size, compiled once: as templates they would be most of what
// many files take to compile.

/// Eigenvalues in rising order and orthonormal eigenvectors of a symmetric matrix.
class SymmetricEigen {
 public:
  explicit SymmetricEigen(const Eigen::MatrixXd& matrix);

  [[nodiscard]] const Eigen::VectorXd& eigenvalues() const { return values_; }
  [[nodiscard]] const Eigen::MatrixXd& eigenvectors() const { return vectors_; }

 private:
  Eigen::VectorXd values_;
  Eigen::MatrixXd vectors_;
};

/// The solution of A x = b, A symmetric and semidefinite.
[[nodiscard]] Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The inverse of a symmetric, semidefinite matrix.
[[nodiscard]] Eigen::MatrixXd symmetric_inverse(const Eigen::MatrixXd& A);

/// The inverse of a square matrix.
[[nodiscard]] Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A);

/// The shortest x of those with the least |A x - b|; empty where A has no columns.
[[nodiscard]] Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A,
                                                  const Eigen::VectorXd& b);

/// The x of least |A x - b|, A of full column rank.
[[nodiscard]] Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b);

/// The x that makes x'Ax - 2b'x least of those with low <= x <= high, A symmetric and semidefinite.
/// On its way there from 0 that falls all the time, so that it is below 0 wherever it ends.
/// @pre low <= 0 <= high
[[nodiscard]] Eigen::VectorXd least_in_box(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                                           const Eigen::VectorXd& low, const Eigen::VectorXd& high);

/// Singular values in falling order with as many left vectors.
struct SingularValues {
  Eigen::VectorXd values;
  Eigen::MatrixXd left;
};
[[nodiscard]] SingularValues singular_values(const Eigen::MatrixXd& A);

}  // namespace kolsky

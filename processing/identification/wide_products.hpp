#pragma once

#include <Eigen/Core>

namespace kolsky {

/// lower += columns columns^T, of which only the lower triangle is meant. Sums run in the same
/// order whatever the machine, so that its results have the same bits everywhere.
void add_square(const Eigen::MatrixXd& columns, Eigen::MatrixXd& lower);

/// A lower triangular matrix to solve with for a few columns at a time, likewise.
class LowerTriangle {
 public:
  LowerTriangle() = default;
  explicit LowerTriangle(const Eigen::MatrixXd& lower);

  /// columns = lower^-1 columns
  void solve_in_place(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_;
};

}  // namespace kolsky

#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "processing/waves/compliance.hpp"

namespace kolsky {

// Sums run in the same order whatever the machine, so that results have the same bits everywhere.

/// A tall matrix that is worked on eight columns at a time; those beyond the last are 0.
class EightColumns {
 public:
  static constexpr Eigen::Index kEight = 8;

  EightColumns(Eigen::Index rows, Eigen::Index columns);

  [[nodiscard]] Eigen::Index rows() const { return rows_; }
  [[nodiscard]] Eigen::Index panels() const { return panels_; }
  /// Eight columns, row by row.
  [[nodiscard]] double* panel(Eigen::Index i) { return numbers_.data() + i * rows_ * kEight; }
  [[nodiscard]] const double* panel(Eigen::Index i) const {
    return numbers_.data() + i * rows_ * kEight;
  }
  [[nodiscard]] double& operator()(Eigen::Index row, Eigen::Index column) {
    return panel(column / kEight)[row * kEight + column % kEight];
  }
  [[nodiscard]] double operator()(Eigen::Index row, Eigen::Index column) const {
    return panel(column / kEight)[row * kEight + column % kEight];
  }
  void scale(Eigen::Index column, double factor) {
    for (Eigen::Index row = 0; row < rows_; ++row) {
      (*this)(row, column) *= factor;
    }
  }
  void clear() { std::fill(numbers_.begin(), numbers_.end(), 0.0); }

 private:
  Eigen::Index rows_;
  Eigen::Index panels_;
  std::vector<double> numbers_;
};

/// columns^T columns.
[[nodiscard]] Eigen::MatrixXd square_of(const EightColumns& columns);

/// lower += columns^T columns, of which only the lower triangle of as many columns is meant.
void add_square(const EightColumns& columns, Eigen::MatrixXd& lower);

/// A lower triangular matrix to solve with for a few columns at a time.
class LowerTriangle {
 public:
  LowerTriangle() = default;
  explicit LowerTriangle(const Eigen::MatrixXd& lower);

  /// The columns' first rows = lower^-1 those.
  void solve_in_place(EightColumns& columns) const;
  /// Column = its first numbers times the transposed lower^-1.
  void solve_transposed_in_place(Eigen::Ref<Eigen::MatrixXd> columns) const;

 private:
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows_;
};

/// Multiplies stretches of rows from `first` on, each the real parts of as many complex numbers
/// before their imaginary parts, by a lower triangular complex matrix each.
/// @param triangles  one after the other, row by row
void multiply_in_place(std::span<const Complex> triangles, Eigen::Index size, Eigen::Index first,
                       EightColumns& columns);

}  // namespace kolsky

#include "processing/criticism/noise/small_factor.hpp"

#include <cmath>
#include <complex>

namespace kolsky {

namespace {

bool factorise(Eigen::MatrixXcd& matrix) {
  for (Eigen::Index j = 0; j < matrix.rows(); ++j) {
    double square = matrix(j, j).real();
    for (Eigen::Index k = 0; k < j; ++k) {
      square -= std::norm(matrix(j, k));
      matrix(k, j) = 0.0;
    }
    if (!(square > 0.0)) {
      return false;
    }
    const double own = std::sqrt(square);
    matrix(j, j) = own;
    for (Eigen::Index i = j + 1; i < matrix.rows(); ++i) {
      for (Eigen::Index k = 0; k < j; ++k) {
        matrix(i, j) -= matrix(i, k) * std::conj(matrix(j, k));
      }
      matrix(i, j) /= own;
    }
  }
  return true;
}

}  // namespace

bool invert_factor(Eigen::MatrixXcd& matrix) {
  if (!factorise(matrix)) {
    return false;
  }
  // Column by column: of a row, what is right of the column is still the factor's.
  for (Eigen::Index j = 0; j < matrix.rows(); ++j) {
    matrix(j, j) = 1.0 / matrix(j, j).real();
    for (Eigen::Index i = j + 1; i < matrix.rows(); ++i) {
      std::complex<double> sum = matrix(i, j) * matrix(j, j);
      for (Eigen::Index k = j + 1; k < i; ++k) {
        sum += matrix(i, k) * matrix(k, j);
      }
      matrix(i, j) = -sum / matrix(i, i).real();
    }
  }
  return true;
}

}  // namespace kolsky

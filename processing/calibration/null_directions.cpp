#include "processing/calibration/null_directions.hpp"

#include <Eigen/Core>
#include <cmath>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// Row echelon form with the largest entries as pivots: each row is 1 at its pivot, where the
/// others are 0, so that rows have few members.
void reduce(Eigen::MatrixXd& rows) {
  std::vector<bool> used(static_cast<std::size_t>(rows.cols()), false);
  for (Eigen::Index r = 0; r < rows.rows(); ++r) {
    Eigen::Index pivot = -1;
    for (Eigen::Index c = 0; c < rows.cols(); ++c) {
      if (!used[static_cast<std::size_t>(c)] &&
          (pivot < 0 || std::abs(rows(r, c)) > std::abs(rows(r, pivot)))) {
        pivot = c;
      }
    }
    used[static_cast<std::size_t>(pivot)] = true;
    rows.row(r) /= rows(r, pivot);
    for (Eigen::Index other = 0; other < rows.rows(); ++other) {
      if (other != r) {
        rows.row(other) -= rows(other, pivot) * rows.row(r);
      }
    }
  }
}

}  // namespace

std::vector<std::string> null_directions(const Eigen::MatrixXd& information,
                                         const std::vector<std::string>& names) {
  constexpr double kUnseen = 1.0;
  constexpr double kMember = 0.03;
  const SymmetricEigen solver(information);
  Eigen::Index count = 0;
  while (count < information.rows() && solver.eigenvalues()[count] < kUnseen) {
    ++count;
  }
  std::vector<std::string> list;
  if (count == 0) {
    return list;
  }
  Eigen::MatrixXd rows = solver.eigenvectors().leftCols(count).transpose();
  reduce(rows);
  for (Eigen::Index r = 0; r < count; ++r) {
    std::string members;
    for (Eigen::Index c = 0; c < rows.cols(); ++c) {
      if (std::abs(rows(r, c)) > kMember * rows.row(r).cwiseAbs().maxCoeff()) {
        members += (members.empty() ? "" : ", ") + names[static_cast<std::size_t>(c)];
      }
    }
    list.push_back(members);
  }
  return list;
}

}  // namespace kolsky

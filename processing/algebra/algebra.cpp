#include "processing/algebra/algebra.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace kolsky {

SymmetricEigen::SymmetricEigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  values_ = solver.eigenvalues();
  vectors_ = solver.eigenvectors();
}

Eigen::VectorXd solve_symmetric(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.ldlt().solve(b);
}

Eigen::MatrixXd symmetric_inverse(const Eigen::MatrixXd& A) {
  return A.ldlt().solve(Eigen::MatrixXd::Identity(A.rows(), A.cols()));
}

Eigen::MatrixXd inverse_of(const Eigen::MatrixXd& A) {
  return A.inverse();
}

Eigen::VectorXd least_norm_solution(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  // A decomposition of nothing reads what is not there.
  return A.cols() == 0 ? Eigen::VectorXd() : A.completeOrthogonalDecomposition().solve(b).eval();
}

Eigen::VectorXd least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& b) {
  return A.colPivHouseholderQr().solve(b);
}

namespace {

enum class Held { nowhere, low, high };

/// The least with some numbers held where x has them.
Eigen::VectorXd least_beside(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                             const Eigen::VectorXd& x, const std::vector<Held>& held) {
  Eigen::MatrixXd open = A;
  Eigen::VectorXd pull = b;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (held[static_cast<std::size_t>(i)] != Held::nowhere) {
      pull -= A.col(i) * x[i];
      open.row(i).setZero();
      open.col(i).setZero();
    }
  }
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    if (held[static_cast<std::size_t>(i)] != Held::nowhere) {
      open(i, i) = 1.0;
      pull[i] = x[i];
    }
  }
  return solve_symmetric(open, pull);
}

}  // namespace

/// By an active set: straight to the least of what is open, or as far as to the first bound on the
/// way, which then holds; a bound that the parabola pulls away from lets go.
Eigen::VectorXd least_in_box(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                             const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  const Eigen::Index count = b.size();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(count);
  std::vector<Held> held(static_cast<std::size_t>(count), Held::nowhere);
  for (Eigen::Index round = 0; round < 4 * count + 4; ++round) {
    const Eigen::VectorXd way = least_beside(A, b, x, held) - x;
    double share = 1.0;
    Eigen::Index first = -1;
    for (Eigen::Index i = 0; i < count; ++i) {
      const double room = way[i] > 0.0 ? high[i] - x[i] : low[i] - x[i];
      if (held[static_cast<std::size_t>(i)] == Held::nowhere && std::abs(way[i]) > std::abs(room) &&
          room / way[i] <= share) {
        share = room / way[i];
        first = i;
      }
    }
    x += share * way;
    if (first >= 0) {
      const bool up = way[first] > 0.0;
      held[static_cast<std::size_t>(first)] = up ? Held::high : Held::low;
      x[first] = up ? high[first] : low[first];
      continue;
    }
    const Eigen::VectorXd pull = b - A * x;
    Eigen::Index freed = -1;
    double most = 0.0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const Held at = held[static_cast<std::size_t>(i)];
      const double inwards = at == Held::high ? -pull[i] : at == Held::low ? pull[i] : 0.0;
      // In units of what the number itself would gain: beyond what rounding leaves.
      const double gain = A(i, i) > 0.0 ? inwards * std::abs(inwards) / A(i, i) : 0.0;
      if (gain > most) {
        most = gain;
        freed = i;
      }
    }
    constexpr double kRounding = 1e-12;
    if (freed < 0 || most <= kRounding * std::abs(b.dot(x))) {
      break;
    }
    held[static_cast<std::size_t>(freed)] = Held::nowhere;
  }
  return x;
}

SingularValues singular_values(const Eigen::MatrixXd& A) {
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeThinU);
  return {svd.singularValues(), svd.matrixU()};
}

}  // namespace kolsky

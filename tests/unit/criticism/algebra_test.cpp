#include "processing/algebra/algebra.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace kolsky {
namespace {

// Of a row of ones every x of sum 2 is exact; the shortest has equal parts.
TEST(LeastNormSolution, IsTheShortest) {
  const Eigen::MatrixXd row = Eigen::MatrixXd::Ones(1, 4);
  const Eigen::VectorXd x = least_norm_solution(row, Eigen::VectorXd::Constant(1, 2.0));
  EXPECT_LT((x - Eigen::VectorXd::Constant(4, 0.5)).norm(), 1e-12);
}

// A fit all of whose numbers stand at their bounds moves none of them.
TEST(LeastNormSolution, IsEmptyWhereNothingMoves) {
  EXPECT_EQ(least_norm_solution(Eigen::MatrixXd(3, 0), Eigen::VectorXd::Ones(3)).size(), 0);
  EXPECT_EQ(least_norm_solution(Eigen::MatrixXd(0, 0), Eigen::VectorXd(0)).size(), 0);
}

double height(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, const Eigen::VectorXd& x) {
  return x.dot(A * x) - 2.0 * b.dot(x);
}

/// By trying every way of which numbers stand at which bound.
double least_by_trial(const Eigen::MatrixXd& A, const Eigen::VectorXd& b,
                      const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  const Eigen::Index count = b.size();
  double least = std::numeric_limits<double>::infinity();
  for (int way = 0; way < static_cast<int>(std::pow(3, count)); ++way) {
    Eigen::MatrixXd open = A;
    Eigen::VectorXd pull = b;
    int rest = way;
    for (Eigen::Index i = 0; i < count; ++i, rest /= 3) {
      if (rest % 3 != 0) {
        open.row(i).setZero();
        open(i, i) = 1.0;
        pull[i] = rest % 3 == 1 ? low[i] : high[i];
      }
    }
    const Eigen::VectorXd x = inverse_of(open) * pull;
    if ((x - low).minCoeff() > -1e-9 && (high - x).minCoeff() > -1e-9) {
      least = std::min(least, height(A, b, x));
    }
  }
  return least;
}

TEST(LeastInBox, IsTheLeastOfAllThatStandAtSomeBounds) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::exponential_distribution<double> room(1.0);
  for (int n = 0; n < 300; ++n) {
    const Eigen::Index count = 2 + n % 3;
    const auto draw = [&] { return normal(random); };
    const Eigen::MatrixXd root = Eigen::MatrixXd::NullaryExpr(count, count, draw);
    const Eigen::MatrixXd A =
        root.transpose() * root + 0.01 * Eigen::MatrixXd::Identity(count, count);
    const Eigen::VectorXd b = 3.0 * Eigen::VectorXd::NullaryExpr(count, draw);
    const auto distance = [&] { return n % 5 == 0 ? 0.0 : room(random); };
    const Eigen::VectorXd low = -Eigen::VectorXd::NullaryExpr(count, distance);
    const Eigen::VectorXd high = Eigen::VectorXd::NullaryExpr(count, distance);
    const Eigen::VectorXd x = least_in_box(A, b, low, high);
    EXPECT_GE((x - low).minCoeff(), -1e-12);
    EXPECT_GE((high - x).minCoeff(), -1e-12);
    EXPECT_NEAR(height(A, b, x), least_by_trial(A, b, low, high), 1e-9);
  }
}

// Of two that hang together one is held by its bound: the other, which would have left by far
// alone, comes back to where it is best beside that.
TEST(LeastInBox, LetsGoOfABoundThatOnlyTheFirstWayMet) {
  Eigen::MatrixXd A(2, 2);
  A << 1.0, 0.99, 0.99, 1.0;
  const Eigen::VectorXd b = A * Eigen::Vector2d(10.0, -10.0);
  const Eigen::VectorXd x =
      least_in_box(A, b, Eigen::Vector2d(-20.0, -9.0), Eigen::Vector2d(1.0, 20.0));
  EXPECT_NEAR(x[0], 1.0, 1e-12);
  EXPECT_NEAR(x[1], -1.09, 1e-9);
  EXPECT_LT(height(A, b, x), 0.0);
}

}  // namespace
}  // namespace kolsky

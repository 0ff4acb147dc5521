#include "processing/algebra/algebra.hpp"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace kolsky

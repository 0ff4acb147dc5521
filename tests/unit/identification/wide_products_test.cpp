#include "processing/identification/wide_products.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

namespace kolsky {
namespace {

TEST(WideProducts, SquaresAddToTheLowerTriangleOfAnySize) {
  for (const Eigen::Index rows : {1, 4, 7, 8, 9, 22}) {
    const Eigen::MatrixXd columns = Eigen::MatrixXd::Random(rows, 13);
    const Eigen::MatrixXd before = Eigen::MatrixXd::Random(rows, rows);
    Eigen::MatrixXd sum = before;
    add_square(columns, sum);
    const Eigen::MatrixXd whole = before + columns * columns.transpose();
    for (Eigen::Index i = 0; i < rows; ++i) {
      for (Eigen::Index j = 0; j < rows; ++j) {
        EXPECT_NEAR(sum(i, j), j <= i ? whole(i, j) : before(i, j), 1e-14) << rows;
      }
    }
  }
}

TEST(WideProducts, ATriangleIsSolvedForAnyNumberOfColumns) {
  for (const Eigen::Index size : {1, 2, 5, 16}) {
    Eigen::MatrixXd factor = Eigen::MatrixXd::Random(size, size);
    factor.diagonal().array() += 3.0;  // what lies above the diagonal must not matter
    for (const Eigen::Index count : {1, 8, 11}) {
      const Eigen::MatrixXd right = Eigen::MatrixXd::Random(size, count);
      Eigen::MatrixXd solved = right;
      LowerTriangle(factor).solve_in_place(solved);
      const Eigen::MatrixXd back = factor.triangularView<Eigen::Lower>() * solved;
      EXPECT_LT((back - right).cwiseAbs().maxCoeff(), 1e-14) << size << " " << count;
    }
  }
}

}  // namespace
}  // namespace kolsky

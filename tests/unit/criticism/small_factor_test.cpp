#include "processing/criticism/noise/small_factor.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <complex>
#include <random>

namespace kolsky {
namespace {

TEST(SmallFactor, InverseOfTheFactorMakesTheMatrixOne) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const Eigen::Index size : {1, 2, 3, 5, 8}) {
    const Eigen::MatrixXcd any = Eigen::MatrixXcd::NullaryExpr(
        size, size, [&] { return std::complex<double>(normal(random), normal(random)); });
    const Eigen::MatrixXcd matrix =
        any * any.adjoint() + 0.01 * Eigen::MatrixXcd::Identity(size, size);
    Eigen::MatrixXcd inverse = matrix.triangularView<Eigen::Lower>();
    ASSERT_TRUE(invert_factor(inverse));
    const Eigen::MatrixXcd one = inverse * matrix * inverse.adjoint();
    EXPECT_LT((one - Eigen::MatrixXcd::Identity(size, size)).norm(), 1e-10) << size;
    EXPECT_EQ(Eigen::MatrixXcd(inverse.triangularView<Eigen::StrictlyUpper>()).norm(), 0.0);
  }
}

TEST(SmallFactor, WhatIsNotPositiveDefiniteHasNone) {
  Eigen::MatrixXcd matrix(2, 2);
  matrix << 1.0, 0.0, std::complex<double>(0.0, 2.0), 3.0;
  EXPECT_FALSE(invert_factor(matrix));
}

}  // namespace
}  // namespace kolsky

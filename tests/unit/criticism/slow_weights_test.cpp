#include "processing/criticism/search/slow_weights.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

// Slow noise of which nothing is felt in the records has no modes, and takes nothing off.
TEST(SlowWeights, OfNothingThatIsFeltTakeNothingOff) {
  const Eigen::MatrixXd parts = Eigen::MatrixXd::Constant(8, 2, 1e-6);
  const Eigen::MatrixXd residual = Eigen::MatrixXd::Ones(8, 3);
  const SlowWeights weights(parts, residual);
  Eigen::MatrixXd rows = Eigen::MatrixXd::Ones(24, 1);
  weights.weigh(rows, 8);
  EXPECT_EQ(rows, Eigen::MatrixXd::Ones(24, 1));
}

TEST(SlowWeights, TakeOffWhatIsSlow) {
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(8, 1);
  parts.topRows(4).setConstant(0.5);
  const Eigen::MatrixXd residual = parts * Eigen::MatrixXd::Constant(1, 3, 4.0);
  const SlowWeights weights(parts, residual);
  Eigen::MatrixXd rows = parts;
  weights.weigh(rows, 8);
  EXPECT_LT(rows.norm(), 0.95 * parts.norm());
  EXPECT_GT(rows.norm(), 0.1 * parts.norm());
}

}  // namespace
}  // namespace kolsky

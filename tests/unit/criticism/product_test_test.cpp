// Strengths by shot and gauge that are products, noise, or one gauge's own.
#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <cmath>
#include <random>

#include "processing/criticism/search/product_test.hpp"

namespace kolsky {
namespace {

constexpr Eigen::Index kShots = 6;
constexpr Eigen::Index kGauges = 4;
constexpr Eigen::Index kSize = 2 * kShots * kGauges;

/// Estimates of strengths beside a prior of unit deviation, from measurements of which cosine parts
/// are hardly seen and what all gauges have in common not at all.
class Bench {
 public:
  /// @param common  how much of what all gauges have in common is seen
  explicit Bench(unsigned seed, double common = 0.0) : random_(seed) {
    for (Eigen::Index i = 0; i < kSize; ++i) {
      const Eigen::Index c = i / kGauges;
      const double seen = c < kShots ? 3.0 : 300.0;
      for (Eigen::Index j = c * kGauges; j < (c + 1) * kGauges; ++j) {
        measured_(i, j) =
            seen * ((i == j ? 1.0 : 0.0) - (1.0 - common) / static_cast<double>(kGauges));
      }
    }
    information_ = measured_.transpose() * measured_ + Eigen::MatrixXd::Identity(kSize, kSize);
  }
  double draw() { return normal_(random_); }
  /// Deviations of noise that strengths stand at.
  [[nodiscard]] double seen(const Eigen::VectorXd& truth) const {
    return (measured_ * truth).norm();
  }

  /// @param noise  deviation of what each measurement adds, by gauge
  ProductTest test(const Eigen::VectorXd& truth, const Eigen::VectorXd& noise) {
    Eigen::VectorXd seen = measured_ * truth;
    for (Eigen::Index i = 0; i < kSize; ++i) {
      seen[i] += noise[i % kGauges] * draw();
    }
    const Eigen::VectorXd strengths = information_.ldlt().solve(measured_.transpose() * seen);
    return test_products(strengths, information_, kShots, kGauges);
  }

 private:
  std::mt19937 random_;
  std::normal_distribution<double> normal_;
  Eigen::MatrixXd measured_ = Eigen::MatrixXd::Zero(kSize, kSize);
  Eigen::MatrixXd information_;
};

TEST(ProductTest, FindsNoProductsInNoiseOfAnyPower) {
  for (const double power : {1.0, 30.0}) {
    Bench bench(3);
    constexpr int kTrials = 100;
    int below = 0;
    for (int n = 0; n < kTrials; ++n) {
      const ProductTest test =
          bench.test(Eigen::VectorXd::Zero(kSize), Eigen::VectorXd::Constant(kGauges, power));
      below += test.log_p < std::log(0.05) ? 1 : 0;
      EXPECT_GT(test.log_p, std::log(1e-4));
    }

    EXPECT_LE(below, 13);
  }
}

TEST(ProductTest, FindsAHumThatEveryGaugePicksUpBySomeShare) {
  Bench bench(4);
  for (int n = 0; n < 10; ++n) {
    Eigen::VectorXd shares(kGauges);
    for (double& share : shares) {
      share = 1.0 + 0.4 * bench.draw();
    }
    Eigen::VectorXd truth(kSize);
    for (Eigen::Index shot = 0; shot < kShots; ++shot) {
      const double phase = 6.28 * bench.draw();
      truth.segment(shot * kGauges, kGauges) = 0.3 * std::cos(phase) * shares;
      truth.segment((kShots + shot) * kGauges, kGauges) = 0.3 * std::sin(phase) * shares;
    }
    const ProductTest test = bench.test(truth, Eigen::VectorXd::Ones(kGauges));
    EXPECT_LT(test.log_p, -14.0);
    EXPECT_GT(test.beyond_one_gauge, 30.0);
  }
}

// Twelve deviations in all, of which products with shares of any kind make chance out of hundreds.
TEST(ProductTest, FindsAHumThatIsAlikeAtAllGaugesSooner) {
  Bench bench(6, 0.1);
  int found = 0;
  for (int n = 0; n < 20; ++n) {
    Eigen::VectorXd truth(kSize);
    for (Eigen::Index shot = 0; shot < kShots; ++shot) {
      const double phase = 6.28 * bench.draw();
      truth.segment(shot * kGauges, kGauges).setConstant(std::cos(phase));
      truth.segment((kShots + shot) * kGauges, kGauges).setConstant(std::sin(phase));
    }
    truth *= 12.0 / bench.seen(truth);
    const ProductTest test = bench.test(truth, Eigen::VectorXd::Ones(kGauges));
    found += test.log_p < -6.9 && test.beyond_one_gauge > 25.0 ? 1 : 0;
  }
  EXPECT_GE(found, 16);
}

TEST(ProductTest, ShowsThatOneGaugeAloneIsNoisy) {
  Bench bench(5);
  Eigen::VectorXd noise = Eigen::VectorXd::Ones(kGauges);
  noise[2] = 30.0;
  for (int n = 0; n < 10; ++n) {
    const ProductTest test = bench.test(Eigen::VectorXd::Zero(kSize), noise);
    EXPECT_LT(test.log_p, -7.0);  // near to products indeed
    EXPECT_LT(test.beyond_one_gauge, 30.0);
  }
}

TEST(ProductTest, SaysNothingOfTwoGauges) {
  const ProductTest test =
      test_products(Eigen::VectorXd::Ones(24), 100.0 * Eigen::MatrixXd::Identity(24, 24), 6, 2);
  EXPECT_EQ(test.log_p, 0.0);
}

}  // namespace
}  // namespace kolsky

#include "processing/criticism/impact/solver_share.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <random>

#include "processing/algebra/algebra.hpp"

namespace kolsky {
namespace {

constexpr Eigen::Index kSamples = 14;
constexpr Eigen::Index kSize = kSamples + 1;
constexpr std::size_t kShots = 3;

/// Three speeds of three shots each, a half sine of force.
struct Impacts {
  Impacts() {
    records.window.samples = kSamples;
    records.window.period_s = 30e-6;
    records.behind = {0};
    records.wave_speed_m_per_s = 5000.0;
    for (const double speed : {31.0, 40.0, 51.0}) {
      SpeedGroup group{speed, 0.99 * speed, 1.01 * speed, {}, {-0.005, 0.0, 0.005}};
      ImpactShape shape{Eigen::VectorXd(kSize), Eigen::VectorXd(kSize), Eigen::VectorXd(kSize)};
      for (Eigen::Index i = 0; i < kSamples; ++i) {
        const double phase = std::numbers::pi * (static_cast<double>(i) + 0.5) / kSamples;
        shape.reading[i] = 5e-6 * speed * std::sin(phase);
        shape.by_time[i] = 5e-6 * speed * std::cos(phase) / 140e-6;
      }
      shape.reading[kSamples] = 0.8 * speed / 5000.0;
      shape.by_time[kSamples] = 0.0;
      shape.by_speed = 1.15 * shape.reading;
      for (std::size_t n = 0; n < kShots; ++n) {
        group.shots.push_back(records.group_of.size());
        records.group_of.push_back(records.groups.size());
        records.rebound.emplace_back(Measured{0.8 * speed / 5000.0, 1e-6});
      }
      records.groups.push_back(group);
      shapes.push_back(shape);
    }
    whitening = std::make_unique<ImpactWhitening>(
        records, shapes,
        ImpactDoubts{1e-14 * Eigen::MatrixXd::Identity(kSamples, kSamples), 1e-3, 1e-3, 5e-3});
  }

  /// What all shots of a speed have alike, whitened.
  [[nodiscard]] Eigen::VectorXd white(const Eigen::VectorXd& means) const {
    std::vector<Eigen::VectorXd> residual;
    for (const std::size_t g : records.group_of) {
      residual.emplace_back(means.segment(static_cast<Eigen::Index>(g) * kSize, kSize));
    }
    return whitening->white(residual);
  }

  /// A draw of what the means may be off by, the force's part of the solver's error `share` times
  /// what is allowed for it.
  [[nodiscard]] Eigen::VectorXd drawn(double share, std::mt19937_64& random) const {
    Eigen::MatrixXd covariance = whitening->solver();
    for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
      for (Eigen::Index j = 0; j < covariance.cols(); ++j) {
        const bool force = i % kSize < kSamples && j % kSize < kSamples;
        covariance(i, j) *= force ? share * share : 1.0;
      }
    }
    for (std::size_t g = 0; g < records.groups.size(); ++g) {
      const Eigen::Index at = static_cast<Eigen::Index>(g) * kSize;
      covariance.block(at, at, kSize, kSize) += whitening->own(g) / static_cast<double>(kShots);
    }
    std::normal_distribution<double> normal;
    Eigen::VectorXd deviates(covariance.rows());
    for (double& deviate : deviates) {
      deviate = normal(random);
    }
    return symmetric_power(covariance, 0.5) * deviates;
  }

  /// Another shape at every speed, in strain.
  [[nodiscard]] Eigen::VectorXd effect(double cycles) const {
    Eigen::VectorXd means = Eigen::VectorXd::Zero(3 * kSize);
    for (Eigen::Index g = 0; g < 3; ++g) {
      const Eigen::VectorXd& force = shapes[static_cast<std::size_t>(g)].reading;
      for (Eigen::Index i = 0; i < kSamples; ++i) {
        means[g * kSize + i] =
            force[i] * force[i] / 3e-4 *
            std::cos(cycles * std::numbers::pi * static_cast<double>(i) / kSamples);
      }
    }
    return means;
  }

  ImpactRecords records;
  std::vector<ImpactShape> shapes;
  std::unique_ptr<ImpactWhitening> whitening;
};

/// A fit of two numbers to such means, and candidates beside it.
/// @param missing  of every candidate's effect
double found(const Impacts& impacts, double share, double missing, std::mt19937_64& random,
             const std::vector<double>& cycles = {1.0}) {
  Eigen::VectorXd means = impacts.drawn(share, random);
  for (const double own : cycles) {
    means += missing * impacts.effect(own);
  }
  const Eigen::VectorXd white = impacts.white(means);
  ModelFit fit;
  fit.jacobian.resize(white.size(), 2);
  fit.jacobian << impacts.white(impacts.effect(0.0)), impacts.white(impacts.effect(2.0));
  fit.information = fit.jacobian.transpose() * fit.jacobian;
  const Eigen::Vector2d pull = fit.jacobian.transpose() * white;
  fit.residual = white - fit.jacobian * solve_symmetric(fit.information, pull);
  std::vector<Direction> directions(cycles.size());
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    directions[i].columns = impacts.white(impacts.effect(cycles[i]));
  }
  return largest_solver_share(*impacts.whitening, fit, std::vector<Candidate>(cycles.size()),
                              directions);
}

TEST(SolverShare, IsTheLargestThatRecordsDoNotContradict) {
  const Impacts impacts;
  std::mt19937_64 random(5);
  for (const double share : {0.15, 0.3, 0.6}) {
    for (const double missing : {0.0, 0.05}) {
      int below = 0;
      double sum = 0.0;
      constexpr int kDraws = 400;
      for (int n = 0; n < kDraws; ++n) {
        const double own = found(impacts, share, missing, random);
        below += own < share ? 1 : 0;
        sum += own / share / kDraws;
      }
      // One in twenty; three deviations of that.
      EXPECT_LE(below, 33) << share << " " << missing;
      EXPECT_LT(sum, 1.35) << share << " " << missing;
    }
  }
}

/// One strength leaves the other effect, which would pass for an error of the calculation.
TEST(SolverShare, IsKnownBesideTwoThatAreMissing) {
  const Impacts impacts;
  std::mt19937_64 random(7);
  constexpr double kShare = 0.3;
  int below = 0;
  double sum = 0.0;
  constexpr int kDraws = 200;
  for (int n = 0; n < kDraws; ++n) {
    const double own = found(impacts, kShare, 0.2, random, {1.0, 3.0});
    below += own < kShare ? 1 : 0;
    sum += own / kShare / kDraws;
  }
  // One in twenty; three deviations of that.
  EXPECT_LE(below, 19);
  EXPECT_LT(sum, 1.35);
}

/// Two strengths that are free take up some of what another code does smoothly: not at the cost of
/// what is allowed for that.
TEST(SolverShare, IsNotLessForCandidatesThatMissNothing) {
  const Impacts impacts;
  std::mt19937_64 random(8);
  for (const double share : {0.3, 0.9}) {
    int below = 0;
    for (int n = 0; n < 200; ++n) {
      below += found(impacts, share, 0.0, random, {1.0, 3.0, 4.0, 5.0}) < share ? 1 : 0;
    }
    // One in twenty; three deviations of that.
    EXPECT_LE(below, 19) << share;
  }
}

TEST(SolverShare, IsNeverMoreThanAllowed) {
  const Impacts impacts;
  std::mt19937_64 random(6);
  EXPECT_EQ(found(impacts, 3.0, 0.0, random), 1.0);
}

}  // namespace
}  // namespace kolsky

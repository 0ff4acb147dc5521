// A posterior carried through impacts, against impacts at values moved by hand.
#include "processing/prediction/ball_prediction.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/base/error.hpp"
#include "processing/impact/impact.hpp"
#include "processing/reduction/ball/contact_numbers.hpp"
#include "tests/unit/impact/paper_ball.hpp"
#include "tests/unit/reduction/ball_bench.hpp"

namespace kolsky {
namespace {

using kolsky::testing::paper_bench;
using kolsky::testing::paper_core;
using kolsky::testing::paper_cover;
using kolsky::testing::Push;

PredictionOptions small() {
  PredictionOptions options;
  options.elements = 220;
  options.fine_elements = 220;
  options.draws = 24;
  return options;
}

impact::ImpactHistory thrown(const Material& core, double speed_m_per_s,
                             const Material& cover = paper_cover()) {
  impact::ImpactModel model =
      impact::impact_on(paper_bench(), {core}, {cover}, impact::TargetKind::dashpot, speed_m_per_s);
  model.elements = 220;
  return impact::simulate(model);
}

BallPrediction only(const MaterialPosterior& core, const Measured& speed) {
  return foretell_impacts(paper_bench(), {core, {paper_cover(), {}}, {}}, {{speed, 50e3, 0.01}},
                          small(), Workers{})
      .front();
}

TEST(ContactNumbers, AreThoseOfAKnownPush) {
  const Push push;
  std::vector<double> force;
  for (int n = 0; n < 600; ++n) {
    force.push_back(push.force_N(1e-6 * n));
  }
  const ContactNumbers numbers = contact_numbers(force, 1e-6, 50e3, 0.01);
  EXPECT_NEAR(numbers.peak_force_N, push.peak_N, 1e-3 * push.peak_N);
  EXPECT_NEAR(numbers.impulse_N_s, push.impulse_N_s(), 1e-4 * push.impulse_N_s());
  EXPECT_NEAR(numbers.contact_time_s, push.time_above_s(0.01), 4e-6);
  EXPECT_NEAR(numbers.foot_s, 0.0, 5e-6);
  EXPECT_EQ(numbers.force_N.size(), force.size());
}

TEST(BallPrediction, WithoutDoubtIsTheImpactItself) {
  const BallPrediction told = only({paper_core(), {}}, {40.3, 0.0});
  const impact::ImpactHistory truth = thrown(paper_core(), 40.3);
  EXPECT_NEAR(told.peak_force_N.value, truth.peak_force_N, 3e-3 * truth.peak_force_N);
  EXPECT_EQ(told.restitution.value, truth.restitution);
  EXPECT_NEAR(told.impulse_N_s.value, truth.impulse_N_s, 1e-6);
  EXPECT_NEAR(told.peak_force_N.sd, 0.0, 1e-9);
  EXPECT_NEAR(told.restitution.sd, 0.0, 1e-14);
  EXPECT_EQ(told.restitution.mesh, 0.0) << "the same mesh twice";
  EXPECT_EQ(told.failed, 0U);
}

// The sd of 24 draws is known to 15 %; more than three of those, and the slope's own bend.
TEST(BallPrediction, DoubtOfAModulusIsItsSlopeTimesIt) {
  MaterialPosterior core{paper_core(), {}};
  const double sd_Pa = 0.01 * core.material.E2_Pa();
  core.covariance[1][1] = sd_Pa * sd_Pa;
  const BallPrediction told = only(core, {40.3, 0.0});
  Material stiffer = paper_core();
  Material softer = paper_core();
  stiffer.E2_Pa().value += sd_Pa;
  softer.E2_Pa().value -= sd_Pa;
  const impact::ImpactHistory high = thrown(stiffer, 40.3);
  const impact::ImpactHistory low = thrown(softer, 40.3);
  const double force_N = std::abs(high.peak_force_N - low.peak_force_N) / 2.0;
  const double restitution = std::abs(high.restitution - low.restitution) / 2.0;
  EXPECT_NEAR(told.peak_force_N.sd, force_N, 0.5 * force_N);
  EXPECT_NEAR(told.restitution.sd, restitution, 0.5 * restitution);
}

TEST(BallPrediction, CorrelatedDoubtsAreDrawnTogether) {
  MaterialPosterior apart{paper_core(), {}};
  const double a = 0.02 * apart.material.E1_Pa();
  const double b = 0.02 * apart.material.E2_Pa();
  apart.covariance[0][0] = a * a;
  apart.covariance[1][1] = b * b;
  MaterialPosterior together = apart;
  together.covariance[0][1] = together.covariance[1][0] = 0.999 * a * b;
  MaterialPosterior against = apart;
  against.covariance[0][1] = against.covariance[1][0] = -0.999 * a * b;
  const double with = only(together, {40.3, 0.0}).peak_force_N.sd;
  const double opposed = only(against, {40.3, 0.0}).peak_force_N.sd;
  EXPECT_GT(with, 1.3 * opposed) << "both moduli stiffen the ball";
}

// Core and cover off by the same bar: their slopes add up, or take from each other.
TEST(BallPrediction, WhatCoreAndCoverShareIsDrawnTogether) {
  BallPosterior ball{{paper_core(), {}}, {paper_cover(), {}}, {}};
  const double core_Pa = 0.02 * ball.core.material.E2_Pa();
  const double cover_Pa = 0.03 * ball.cover.material.E1_Pa();
  ball.core.covariance[1][1] = core_Pa * core_Pa;
  ball.cover.covariance[0][0] = cover_Pa * cover_Pa;
  PredictionOptions options = small();
  options.draws = 120;
  const auto sd_with = [&](double correlation) {
    ball.between[1][0] = correlation * core_Pa * cover_Pa;
    return foretell_impacts(paper_bench(), ball, {{{40.3, 0.0}, 50e3, 0.01}}, options, Workers{})
        .front()
        .peak_force_N.sd;
  };
  const auto slope = [&](bool core) {
    double peaks_N[2] = {0.0, 0.0};
    for (const int side : {-1, 1}) {
      Material moved_core = paper_core();
      Material moved_cover = paper_cover();
      (core ? moved_core.E2_Pa() : moved_cover.E1_Pa()).value += side * (core ? core_Pa : cover_Pa);
      peaks_N[side > 0 ? 1 : 0] = thrown(moved_core, 40.3, moved_cover).peak_force_N;
    }
    return (peaks_N[1] - peaks_N[0]) / 2.0;
  };
  const double by_core = slope(true);
  const double by_cover = slope(false);
  ASSERT_GT(std::abs(by_cover), 0.1 * std::abs(by_core));
  for (const double correlation : {-1.0, 0.0, 1.0}) {
    const double expected =
        std::sqrt(by_core * by_core + by_cover * by_cover + 2.0 * correlation * by_core * by_cover);
    // 120 draws know a deviation to 6.5 %.
    EXPECT_NEAR(sd_with(correlation), expected, 0.2 * expected) << correlation;
  }
}

TEST(BallPrediction, DoubtOfTheSpeedCounts) {
  const BallPrediction told = only({paper_core(), {}}, {40.3, 0.4});
  const double slope =
      (thrown(paper_core(), 40.7).peak_force_N - thrown(paper_core(), 39.9).peak_force_N) / 0.8;
  EXPECT_NEAR(told.peak_force_N.sd, 0.4 * slope, 0.5 * 0.4 * slope);
  ASSERT_FALSE(told.force_sd_N.empty());
  EXPECT_GT(told.force_sd_N[200], 0.0);
}

TEST(BallPrediction, ABenchThatDoesNotFitIsRefused) {
  Bench bench = paper_bench();
  bench.ball->core_diameter_m.value = 0.038;
  EXPECT_THROW((void)foretell_impacts(bench, {{paper_core(), {}}, {paper_cover(), {}}, {}},
                                      {{{40.3, 0.0}, 50e3, 0.01}}, small(), Workers{}),
               InputError);
}

}  // namespace
}  // namespace kolsky

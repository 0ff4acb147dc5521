// Impacts against the d'Alembert solution of a pushed thin bar, in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/impact/bench_impact.hpp"
#include "processing/impact/impact.hpp"
#include "processing/reduction/ball/ball_repeats.hpp"
#include "processing/reduction/ball/contact_numbers.hpp"
#include "processing/reduction/reducer.hpp"
#include "tests/unit/reduction/ball_bench.hpp"

namespace kolsky {
namespace {

using kolsky::testing::ball_bench;
using kolsky::testing::ball_shot;
using kolsky::testing::Push;

constexpr double kSpeed_m_per_s = 31.1;

std::function<double(double)> force_of(const Push& push) {
  return [push](double time_s) { return push.force_N(time_s); };
}

BallImpact reduced(const Shot& shot, const ReductionOptions& options = {}) {
  const Reduction reduction = Reducer(options).reduce(shot);
  EXPECT_TRUE(reduction.quality.reducible) << reduction.quality.reason;
  return reduction.ball.value_or(BallImpact{});
}

const Check& check_of(const Reduction& reduction, const std::string& name) {
  const auto& checks = reduction.quality.checks;
  const auto found = std::find_if(checks.begin(), checks.end(),
                                  [&](const Check& check) { return check.name == name; });
  EXPECT_NE(found, checks.end()) << name;
  return *found;
}

TEST(Ball, ForceIsCarriedBackToTheFaceFromEveryPlace) {
  const Push push;
  for (const double position_m : {0.05, 0.25, 1.0}) {
    const Shot shot = ball_shot(ball_bench({position_m}), force_of(push));
    const Reduction reduction = Reducer().reduce(shot);
    ASSERT_TRUE(reduction.ball) << reduction.quality.reason;
    const BallImpact& ball = *reduction.ball;
    EXPECT_NEAR(reduction.arrival_s, 1203.4e-6, 5e-6);
    // t = 0 as found moves the history; compare it at the record's own times.
    double worst = 0.0;
    for (std::size_t n = 0; n < ball.time_s.size(); ++n) {
      const double time_s = ball.time_s[n] + reduction.arrival_s - 1203.4e-6;
      worst = std::max(worst, std::abs(ball.force_N[n] - push.force_N(time_s)));
    }
    EXPECT_LT(worst, 2e-3 * push.peak_N) << position_m;
    EXPECT_NEAR(ball.peak_force_N, push.peak_N, 5e-4 * push.peak_N);
    EXPECT_NEAR(ball.impulse_N_s, push.impulse_N_s(), 2e-4 * push.impulse_N_s());
    EXPECT_EQ(ball.contact_threshold, 0.01);
    EXPECT_NEAR(ball.contact_time_s, push.time_above_s(0.01), 4e-6);
    EXPECT_EQ(reduction.quality.verdict(), Verdict::warn) << "only the speeds are missing";
    EXPECT_EQ(check_of(reduction, "speeds").verdict, Verdict::warn);
  }
}

TEST(Ball, WindowIsThePapers) {
  const Shot shot = ball_shot(ball_bench(), force_of({}));
  const BallImpact ball = reduced(shot);
  EXPECT_NEAR(ball.clean_from_s, 49.4e-6, 0.1e-6);
  ASSERT_EQ(ball.stations.size(), 1U);
  EXPECT_NEAR(ball.stations[0].clean_until_s, 1137e-6, 1e-6);
  EXPECT_NEAR(ball.clean_until_s, 1137e-6 - 49.4e-6, 1e-6) << "as seen from the face";
  EXPECT_LT(ball.time_s.back(), ball.clean_until_s);
  EXPECT_GT(ball.time_s.back(), 0.98 * ball.clean_until_s);
}

TEST(Ball, RestitutionBothWaysAndMomentum) {
  const Push push;
  Shot shot = ball_shot(ball_bench(), force_of(push));
  // What the impulse makes of the ball, by Newton.
  const double out = push.impulse_N_s() / 0.0434 - kSpeed_m_per_s;
  shot.meta["incident_speed_m_per_s"] = "31.1";
  shot.meta["incident_speed_m_per_s_sd"] = "0.1";
  shot.meta["rebound_speed_m_per_s"] = std::to_string(out);
  shot.meta["rebound_speed_m_per_s_sd"] = "0.1";
  shot.bench.ball->mass_kg->sd = 0.0434e-3;
  const Reduction reduction = Reducer().reduce(shot);
  const BallImpact& ball = *reduction.ball;
  ASSERT_TRUE(ball.restitution_by_speed && ball.restitution_by_impulse && ball.momentum_excess);
  const double e = out / kSpeed_m_per_s;
  EXPECT_NEAR(*ball.restitution_by_speed, e, 1e-6);
  EXPECT_NEAR(ball.restitution_by_speed->sd, std::hypot(0.1 / 31.1, 0.1 / out) * e, 1e-6);
  EXPECT_NEAR(*ball.restitution_by_impulse, e, 5e-4);
  EXPECT_NEAR(ball.restitution_by_impulse->sd, (1.0 + e) * std::hypot(0.1 / 31.1, 1e-3), 2e-5);
  EXPECT_NEAR(*ball.momentum_excess, 0.0, 3e-4);
  EXPECT_EQ(check_of(reduction, "restitution").verdict, Verdict::pass);
  EXPECT_EQ(check_of(reduction, "momentum").verdict, Verdict::pass);
  EXPECT_EQ(ball.speed_source, "meta");
  EXPECT_EQ(reduction.quality.verdict(), Verdict::pass);
}

TEST(Ball, AWrongGaugeFactorShowsInMomentumAndRestitution) {
  const Push push;
  const double out = push.impulse_N_s() / 0.0434 - kSpeed_m_per_s;
  Shot shot = ball_shot(ball_bench(), [&](double t) { return 1.05 * push.force_N(t); });
  shot.meta = {{"incident_speed_m_per_s", "31.1"}, {"rebound_speed_m_per_s", std::to_string(out)}};
  const Reduction reduction = Reducer().reduce(shot);
  EXPECT_NEAR(*reduction.ball->momentum_excess, 0.05, 5e-4);
  EXPECT_EQ(check_of(reduction, "momentum").verdict, Verdict::warn);
  EXPECT_EQ(check_of(reduction, "restitution").verdict, Verdict::warn);
  EXPECT_EQ(reduction.quality.verdict(), Verdict::warn);
}

TEST(Ball, ABallThatWouldLeaveFasterThanItCameIsNotBelieved) {
  const Push push;
  Shot shot = ball_shot(ball_bench(), force_of(push));
  shot.meta = {{"incident_speed_m_per_s", "31.1"}};
  EXPECT_EQ(check_of(Reducer().reduce(shot), "restitution_possible").verdict, Verdict::pass);
  shot.bench.ball->mass_kg = {0.5 * 0.0434};
  const Reduction light = Reducer().reduce(shot);
  EXPECT_GT(*light.ball->restitution_by_impulse, 1.5);
  EXPECT_EQ(check_of(light, "restitution_possible").verdict, Verdict::warn);
  shot.bench.ball->mass_kg = {2.5 * 0.0434};
  EXPECT_EQ(check_of(Reducer().reduce(shot), "restitution_possible").verdict, Verdict::warn);

  shot.bench.ball->mass_kg.reset();
  shot.meta = {{"incident_speed_m_per_s", "25"}, {"rebound_speed_m_per_s", "31.1"}};
  EXPECT_EQ(check_of(Reducer().reduce(shot), "restitution_possible").verdict, Verdict::warn);
}

TEST(Ball, NoiseGivesTheDeviationsThatRepeatsHave) {
  const Push push;
  double impulse_z2 = 0.0;
  double peak_z2 = 0.0;
  constexpr unsigned kRepeats = 40;
  for (unsigned seed = 1; seed <= kRepeats; ++seed) {
    const Shot shot = ball_shot(ball_bench(), force_of(push), {.noise_strain = 2e-6, .seed = seed});
    const BallImpact ball = reduced(shot);
    impulse_z2 += std::pow((ball.impulse_N_s - push.impulse_N_s()) / ball.impulse_N_s.sd, 2);
    peak_z2 += std::pow((ball.peak_force_N - push.peak_N) / ball.peak_force_N.sd, 2);
    EXPECT_LT(ball.impulse_N_s.sd, 5e-3 * push.impulse_N_s());
  }
  // A chi-square of 40 lies within 0.35 and 2 of its mean, 1e-4 on either side.
  EXPECT_GT(impulse_z2 / kRepeats, 0.35);
  EXPECT_LT(impulse_z2 / kRepeats, 2.0);
  EXPECT_GT(peak_z2 / kRepeats, 0.2);
  EXPECT_LT(peak_z2 / kRepeats, 3.0);
}

TEST(Ball, QuieterGaugesCountMore) {
  const Push push;
  const Bench bench = ball_bench({0.25, 0.5});
  Shot loud = ball_shot(bench, force_of(push), {.noise_strain = 4e-6});
  const Shot quiet = ball_shot(bench, force_of(push), {.noise_strain = 1e-6, .seed = 2});
  loud.channels[1] = quiet.channels[1];
  const BallImpact ball = reduced(loud);
  ASSERT_EQ(ball.stations.size(), 2U);
  EXPECT_NEAR(ball.stations[0].weight + ball.stations[1].weight, 1.0, 1e-12);
  EXPECT_NEAR(ball.stations[1].weight, 16.0 / 17.0, 0.02);
  EXPECT_NEAR(ball.impulse_N_s, push.impulse_N_s(), 4.0 * ball.impulse_N_s.sd);
}

TEST(Ball, AGaugeWhoseWindowIsTooShortIsLeftOut) {
  const Push push;
  const BallImpact ball = reduced(ball_shot(ball_bench({0.25, 2.2}), force_of(push)));
  ASSERT_EQ(ball.stations.size(), 2U);
  EXPECT_EQ(ball.stations[0].weight, 1.0);
  EXPECT_EQ(ball.stations[1].weight, 0.0) << "the far end answers 316 us after first touch";
  EXPECT_TRUE(ball.contact_over);
  EXPECT_NEAR(ball.impulse_N_s, push.impulse_N_s(), 5e-4 * push.impulse_N_s());
}

TEST(Ball, AContactThatOutlastsTheBarIsSaidAndGivesNoRestitution) {
  Bench bench = ball_bench();
  bench.input.length_m = {1.0};
  Shot shot = ball_shot(bench, force_of({}));
  shot.meta = {{"incident_speed_m_per_s", "31.1"}, {"rebound_speed_m_per_s", "25"}};
  const Reduction reduction = Reducer().reduce(shot);
  ASSERT_TRUE(reduction.ball);
  EXPECT_FALSE(reduction.ball->contact_over);
  EXPECT_EQ(check_of(reduction, "window_overlap").verdict, Verdict::fail);
  EXPECT_FALSE(reduction.ball->restitution_by_impulse);
  EXPECT_TRUE(reduction.ball->restitution_by_speed);
}

TEST(Ball, SemiconductorBridgesAreMadeStraight) {
  // A quarter bridge solved by hand: dR/R = (120 + 4000 e) e of tensile strain, one volt, gain 10.
  const auto volts = [](double compression) {
    const double e = -compression;
    const double r = (120.0 + 4000.0 * e) * e;
    return -10.0 * (0.5 * (2.0 + 2.0 * r) / (2.0 + r) - 0.5);
  };
  Bench bench = ball_bench();
  bench.gauges[0].unit = "V";
  bench.gauges[0].bridge = Bridge{};
  bench.gauges[0].bridge->gauge_factor = {120.0};
  bench.gauges[0].bridge->gauge_factor_per_strain = {4000.0};
  bench.gauges[0].bridge->excitation_V = {1.0};
  bench.gauges[0].bridge->gain = {10.0};
  const Push push{16650.0, 404e-6};
  Shot shot = ball_shot(bench, force_of(push), {.scale = 1e-8}, volts);
  const BallImpact ball = reduced(shot);
  EXPECT_NEAR(ball.peak_force_N, push.peak_N, 5e-4 * push.peak_N);
  shot.bench.gauges[0].bridge->gauge_factor_per_strain = {0.0};
  const BallImpact bent = reduced(shot);
  EXPECT_NEAR(bent.peak_force_N / push.peak_N, 1.0 - 4000.0 * 257e-6 / 120.0, 1e-3)
      << "the 257 microstrain of 51 m/s err by 0.9 %";
}

/// A ball on the bar itself in finite elements: true lateral inertia, surface strain, ringing.
struct MeshedImpact {
  impact::ImpactHistory history;
  Shot shot;
};

MeshedImpact meshed(double position_m) {
  Bench bench = ball_bench({position_m});
  bench.input.length_m = {1.8};
  const Material core = three_element_material({1140.0}, {0.376}, {121e6}, {143e6}, {2860.0}, "");
  const Material cover = three_element_material({960.0}, {0.319}, {987e6}, {452e6}, {6020.0}, "");
  impact::ImpactModel model =
      impact::impact_on(bench, {core}, {cover}, impact::TargetKind::bar, 40.3);
  model.elements = 512;
  model.bar_elements_across = 6;
  model.gauge_positions_m = {position_m};
  model.duration_s = 800e-6;
  MeshedImpact meshed{impact::simulate(model), {}};
  const auto& strain = meshed.history.gauge_strain[0];
  const auto& times = meshed.history.time_s;
  // The history's own samples, 300 us of quiet before them.
  const auto lead = static_cast<std::size_t>(300);
  meshed.shot = ball_shot(bench, [](double) { return 0.0; }, {.samples = lead + strain.size()});
  for (std::size_t n = 0; n < strain.size(); ++n) {
    meshed.shot.channels[0].codes[lead + n] =
        static_cast<std::int32_t>(std::lround(strain[n] / 1e-9));
  }
  EXPECT_NEAR(times[1] - times[0], 1e-6, 1e-12);
  return meshed;
}

// Rms of measured less computed force over the contact, of the peak; both low-passed alike.
double history_error(const MeshedImpact& meshed, WaveTheory theory) {
  ReductionOptions options;
  options.theory = theory;
  options.band_limit_Hz = 30e3;
  const Reduction reduction = Reducer(options).reduce(meshed.shot);
  const ContactNumbers truth = contact_numbers(meshed.history.force_N, 1e-6, 30e3, 0.01);
  const BallImpact& ball = *reduction.ball;
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t n = 0; n < ball.time_s.size() && ball.time_s[n] < 400e-6; ++n) {
    // From the record's first sample to the history's first.
    const double place = (ball.time_s[n] + reduction.arrival_s) * 1e6 - 300.0;
    if (place < 0.0) {
      continue;
    }
    const auto k = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(k);
    const double force_N = (1.0 - share) * truth.force_N[k] + share * truth.force_N[k + 1];
    squares += std::pow(ball.force_N[n] - force_N, 2);
    ++count;
  }
  return std::sqrt(squares / static_cast<double>(count)) / truth.peak_force_N;
}

TEST(Ball, OnAMeshedBarIsTheComputedContactForce) {
  const MeshedImpact near = meshed(0.25);
  const MeshedImpact far = meshed(0.8);
  EXPECT_LT(history_error(near, WaveTheory::elementary), 5e-3);
  EXPECT_LT(history_error(near, WaveTheory::exact), 4e-3);
  EXPECT_LT(history_error(far, WaveTheory::exact), 4e-3);
  EXPECT_LT(history_error(far, WaveTheory::exact), history_error(far, WaveTheory::elementary))
      << "eight tenths of a metre disperse";
}

TEST(Ball, DeviationsOfBarAndGaugeCount) {
  Bench bench = ball_bench({0.25, 0.5});
  bench.input.youngs_modulus_Pa->sd = 113e7;
  bench.input.diameter_m.sd = 0.027e-2;
  bench.gauges[0].strain_gain.sd = 0.02;
  const BallImpact ball = reduced(ball_shot(bench, force_of({})));
  // One per cent of the modulus, two of the area, half of the gauge's two.
  EXPECT_NEAR(ball.peak_force_N.sd / ball.peak_force_N, std::sqrt(1e-4 + 4e-4 + 1e-4) * 1.0, 2e-5);
}

// The foot is the push's, later by as much as a slope that has come a fifth as far delays its rise:
// a half sine of 0.5 ms passes 0.3 of its peak 33 us after 0.1. Not where the slope passed a tenth.
TEST(Ball, ABaselineThatSlopesIsNotTheFirstWave) {
  const Push push;
  Shot shot = ball_shot(ball_bench(), force_of(push), {.noise_strain = 0.5e-6});
  const double arrival_s = Reducer().reduce(shot).arrival_s;
  std::vector<std::int32_t>& codes = shot.channels[0].codes;
  const double peak = *std::ranges::max_element(codes);
  for (std::size_t n = 0; n < codes.size(); ++n) {
    const double so_far = static_cast<double>(n) / (arrival_s * shot.rate.Hz());
    codes[n] -= static_cast<std::int32_t>(std::lround(0.2 * peak * so_far));
  }
  const Reduction reduction = Reducer().reduce(shot);
  EXPECT_TRUE(reduction.quality.reducible) << reduction.quality.reason;
  EXPECT_NEAR(reduction.arrival_s, arrival_s, 33e-6);
}

TEST(Ball, WhatCannotBeReducedSaysWhy) {
  Shot still = ball_shot(ball_bench(), [](double) { return 0.0; }, {.noise_strain = 1e-6});
  EXPECT_NE(Reducer().reduce(still).quality.reason.find("no wave"), std::string::npos);
  Shot pulled = ball_shot(ball_bench(), [](double t) { return -Push{}.force_N(t); });
  EXPECT_NE(Reducer().reduce(pulled).quality.reason.find("tensile"), std::string::npos);
  Shot short_record = ball_shot(ball_bench(), force_of({}), {.samples = 1290});
  EXPECT_EQ(Reducer().reduce(short_record).quality.verdict(), Verdict::fail);
  Shot soft = ball_shot(ball_bench(), force_of({}));
  soft.bench.input.youngs_modulus_Pa.reset();
  EXPECT_THROW((void)Reducer().reduce(soft), InputError);
  Shot worded = ball_shot(ball_bench(), force_of({}));
  worded.meta["incident_speed_m_per_s"] = "fast";
  EXPECT_THROW((void)Reducer().reduce(worded), InputError);
}

TEST(Ball, TheSameShotGivesTheSameBits) {
  const Shot shot = ball_shot(ball_bench({0.25, 0.5}), force_of({}), {.noise_strain = 2e-6});
  Reducer reducer;
  const Reduction first = reducer.reduce(shot);
  (void)reducer.reduce(ball_shot(ball_bench({0.3, 0.5}), force_of({})));
  const Reduction again = reducer.reduce(shot);
  EXPECT_EQ(first.ball->force_N, again.ball->force_N);
  EXPECT_EQ(first.ball->impulse_N_s.sd, again.ball->impulse_N_s.sd);
}

TEST(BallRepeats, GroupBySpeedWithMeanAndDeviation) {
  std::vector<BallImpact> impacts;
  for (const double speed : {51.2, 31.0, 40.3, 31.2, 50.8, 31.1}) {
    BallImpact ball;
    ball.incident_speed_m_per_s = Measured{speed};
    ball.peak_force_N = {1000.0 * speed};
    ball.restitution_by_speed = Measured{0.8};
    impacts.push_back(ball);
  }
  impacts.emplace_back();  // without a speed
  const std::vector<BallRepeats> groups = group_by_speed(impacts);
  ASSERT_EQ(groups.size(), 3U);
  EXPECT_EQ(groups[0].members, (std::vector<std::size_t>{1, 5, 3}));
  EXPECT_NEAR(groups[0].speed_m_per_s.mean, 31.1, 1e-12);
  EXPECT_NEAR(groups[0].speed_m_per_s.sd, 0.1, 1e-12);
  EXPECT_NEAR(groups[0].peak_force_N.sd, 100.0, 1e-9);
  EXPECT_EQ(groups[1].peak_force_N.sd, 0.0);
  EXPECT_EQ(groups[2].restitution_by_speed.count, 2U);
  EXPECT_EQ(groups[2].restitution_by_impulse.count, 0U);
}

}  // namespace
}  // namespace kolsky

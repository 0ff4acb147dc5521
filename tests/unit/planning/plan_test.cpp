// Plans against the same shots solved in the time domain.
#include "processing/planning/shot_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "tests/generators/linear_shpb.hpp"

namespace kolsky {
namespace {

using testing::LinearShpb;

Material core() {
  Material material = paper_pmma();
  material.density_kg_m3 = {1140.0};
  material.E1_Pa = {121e6};
  material.E2_Pa = {143e6};
  material.eta2_Pa_s = {2860.0};
  return material;
}

ShotPlan planned(const LinearShpb& model, const Bench& bench) {
  const std::vector<double> first = model.solve().front();
  const PlannedPulse pulse =
      pulse_of_strain(bench, paper_pmma(), *std::max_element(first.begin(), first.end()),
                      model.pulse_s, model.ramp_s);
  return plan_shot(bench, paper_pmma(), core(), pulse, {});
}

TEST(PlanShot, ForetellsTheGaugesAndTheSpecimen) {
  LinearShpb model;
  model.massless = false;
  const auto records = model.solve();
  const ShotPlan plan = planned(model, model.bench());
  for (std::size_t g = 0; g < 2; ++g) {
    const auto [low, high] = std::minmax_element(records[g].begin(), records[g].end());
    EXPECT_NEAR(plan.gauges[g].highest_strain, *high, 5e-3 * *high);
    EXPECT_NEAR(plan.gauges[g].lowest_strain, *low, 0.01 * *high);
    EXPECT_EQ(plan.gauges[g].name, model.bench().gauges[g].name);
  }
  ASSERT_TRUE(plan.reduction.quality.reducible);
  EXPECT_GT(plan.summary.peak_strain, 0.05);
  EXPECT_GT(plan.summary.mean_strain_rate_per_s, 300.0);
  EXPECT_TRUE(plan.quotable.any);
  EXPECT_NEAR(plan.window_s, 273e-6, 2e-6);  // physics.md
  EXPECT_NEAR(plan.returns_s, 1.4 / 2190.0, 2e-6);
  EXPECT_NEAR(plan.specimen_transit_s, 0.004 / std::sqrt(65.5e6 / 1140.0), 0.1e-6);
}

TEST(PlanShot, WarnsOfWhatTheShotWillNotGive) {
  LinearShpb model;
  model.pulse_s = 36e-6;  // what the paper's 40 mm striker makes
  model.ramp_s = 10e-6;
  const ShotPlan plan = planned(model, model.bench());
  EXPECT_EQ(plan.reduction.quality.verdict(), Verdict::warn);
  LinearShpb longer;
  longer.pulse_s = 600e-6;  // the reflection hides most of it
  EXPECT_EQ(planned(longer, longer.bench()).reduction.quality.verdict(), Verdict::fail);
}

TEST(PlanShot, SaysHowFarAGaugeSeesAllOfAPulse) {
  LinearShpb model;
  model.input_length_m = 0.41;
  model.output_length_m = 0.41;
  model.gauge_in_m = 0.25;
  const ShotPlan plan = planned(model, model.bench());
  EXPECT_LT(plan.window_s, model.pulse_s);
  EXPECT_NEAR(plan.whole_pulse_m, 0.5 * 2190.0 * (plan.pulse.duration_s() + plan.pulse.rise_s),
              2e-3);
  EXPECT_EQ(plan.reduction.quality.find("window_overlap")->verdict, Verdict::fail);
  model.gauge_in_m = 0.39;  // 18 us of a rise of 40
  try {
    (void)planned(model, model.bench());
    ADD_FAILURE() << "planned a shot of which no gauge sees the rise";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("too short for this pulse"), std::string::npos)
        << error.what();
  }
}

TEST(PlanShot, TellsTheAmplifiersRangeInVolts) {
  const LinearShpb model;
  Bench bench = model.bench();
  bench.gauges[1].unit = "V";
  bench.gauges[1].strain_per_V = Measured{1e-4};
  const ShotPlan plan = planned(model, bench);
  EXPECT_EQ(plan.gauges[1].unit, "V");
  const double most = std::max(plan.gauges[1].highest_strain, -plan.gauges[1].lowest_strain);
  EXPECT_NEAR(plan.gauges[1].highest_reading, most / 1e-4, 1e-6);
}

TEST(PlanShot, RefusesBarsThatTheModelDoesNotHoldFor) {
  const LinearShpb model;
  Bench bench = model.bench();
  bench.temperature_K = Measured{293.0};
  Material bars = paper_pmma();
  const PlannedPulse pulse = pulse_of_strain(bench, bars, 1e-3, 1e-4, 0.0);
  bars.identified = Material::Identified{std::nullopt, 330.0};
  EXPECT_THROW((void)plan_shot(bench, bars, core(), pulse, {}), InputError);
  bars.identified = Material::Identified{6000.0, 294.5};
  EXPECT_LE(plan_shot(bench, bars, core(), pulse, {}).reduction.band_limit_Hz, 6000.0);
  bars.density_kg_m3 = {2700.0};
  EXPECT_THROW((void)plan_shot(bench, bars, core(), pulse, {}), InputError);
}

TEST(Pulse, OfAStrikerCarriesItsMomentum) {
  const LinearShpb model;
  Bench bench = model.bench();
  bench.striker = Striker{};
  bench.striker->length_m = Measured{0.1};
  bench.striker->diameter_m = Measured{0.015};
  const double mass = 1180.0 * std::numbers::pi * 0.0075 * 0.0075 * 0.1;
  const PlannedPulse alike = pulse_of_striker(bench, paper_pmma(), 10.0, 5e-6);
  ASSERT_EQ(alike.step_force_N.size(), 1U);
  EXPECT_NEAR(alike.step_force_N.front() * alike.step_s, mass * 10.0, 1e-9 * mass);
  // A heavier one pushes in steps, and all of them carry what it had.
  bench.striker->diameter_m = Measured{0.025};
  const PlannedPulse heavy = pulse_of_striker(bench, paper_pmma(), 10.0, 5e-6);
  ASSERT_GT(heavy.step_force_N.size(), 2U);
  double momentum = 0.0;
  for (const double force_N : heavy.step_force_N) {
    momentum += force_N * heavy.step_s;
  }
  EXPECT_NEAR(momentum / (mass * 10.0 * 625.0 / 225.0), 1.0, 0.03);
  double time_integral = 0.0;
  for (int i = 0; i < 20'000; ++i) {
    time_integral += 1e-7 * heavy.force_N(1e-7 * i);
  }
  EXPECT_NEAR(time_integral / momentum, 1.0, 1e-3);
}

TEST(Pulse, RefusesWhatItCannotKnow) {
  const LinearShpb model;
  EXPECT_THROW((void)pulse_of_striker(model.bench(), paper_pmma(), 10.0, 0.0), InputError);
  Bench bar = model.bench();
  bar.kind = BenchKind::bar;
  const PlannedPulse pulse = pulse_of_strain(bar, paper_pmma(), 1e-3, 1e-4, 0.0);
  EXPECT_THROW((void)plan_shot(bar, paper_pmma(), core(), pulse, {}), InputError);
}

}  // namespace
}  // namespace kolsky

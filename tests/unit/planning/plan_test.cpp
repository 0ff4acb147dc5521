// Plans against the same shots solved in the time domain.
#include "processing/planning/shot_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/simulated/bench_model.hpp"
#include "processing/base/error.hpp"
#include "tests/generators/linear_shpb.hpp"

namespace kolsky {
namespace {

using testing::LinearShpb;

Material core() {
  Material material = paper_pmma();
  material.density_kg_m3 = {1140.0};
  material.E1_Pa() = {121e6};
  material.E2_Pa() = {143e6};
  material.eta2_Pa_s() = {2860.0};
  return material;
}

double force_N(const LinearShpb& model) {
  return model.input.E1_Pa * std::numbers::pi * std::pow(model.bar_diameter_m / 2.0, 2) *
         model.peak_strain;
}

ShotPlan planned(const LinearShpb& model, const Bench& bench) {
  const std::vector<double> first = model.solve().front();
  const PlannedPulse pulse =
      pulse_of_strain(bench, paper_pmma(), *std::max_element(first.begin(), first.end()),
                      model.pulse_s, model.ramp_s);
  return plan_shot(bench, paper_pmma(), core(), pulse, {});
}

/// The specimen's own history by the same staggered grid, its faces in touch and no more than that.
SpecimenHistory solved_specimen(const LinearShpb& model) {
  const auto area_m2 = [](double d) { return std::numbers::pi * d * d / 4.0; };
  BenchModel bench;
  bench.input = {model.input_length_m, area_m2(model.bar_diameter_m), model.input};
  bench.specimen =
      RodShape{model.specimen_length_m, area_m2(model.specimen_diameter_m), model.specimen};
  bench.output = {model.output_length_m, area_m2(model.output_diameter_m), model.output};
  bench.pulse = {
      .peak_force_N = force_N(model), .duration_s = model.pulse_s, .ramp_s = model.ramp_s};
  const double step_s = 1.0 / (model.sampling_frequency_Hz * model.steps_per_sample);
  return *run_bench(bench, step_s, static_cast<std::size_t>(model.record_s / step_s)).specimen;
}

double interpolated(const SpecimenHistory& solved, const std::vector<double>& history, double t) {
  const double step_s = solved.time_s[1] - solved.time_s[0];
  const double at = (t - solved.time_s.front()) / step_s;
  const auto n = static_cast<std::size_t>(at);
  return history[n] + (at - static_cast<double>(n)) * (history[n + 1] - history[n]);
}

/// The largest difference over the first `count` samples, as a share of the largest value.
double apart(const Reduction& r, const std::vector<double>& foretold, std::size_t count,
             const SpecimenHistory& solved, const std::vector<double>& history) {
  double most = 0.0;
  double off = 0.0;
  for (std::size_t n = 0; n < count; ++n) {
    const double expected = interpolated(solved, history, r.time_s[n]);
    most = std::max(most, std::abs(expected));
    off = std::max(off, std::abs(foretold[n] - expected));
  }
  return off / most;
}

struct PlannedShape {
  double pulse_s;
  double rise_s;
};

class ForetoldShot : public ::testing::TestWithParam<PlannedShape> {};

// Pulses shorter and longer than what the gauge sees alone, and than the way to a far end and back;
// rises of many samples and of a few.
TEST_P(ForetoldShot, IsTheOneThatIsSolvedInTime) {
  LinearShpb model;
  model.massless = false;
  model.pulse_s = GetParam().pulse_s;
  model.ramp_s = GetParam().rise_s;
  model.record_s = 3e-3;
  const PlannedPulse pulse{.step_force_N = {force_N(model)},
                           .step_s = model.pulse_s - model.ramp_s,
                           .rise_s = model.ramp_s};
  const ShotPlan plan = plan_shot(model.bench(), paper_pmma(), core(), pulse, {});

  const auto records = model.solve();
  const std::size_t samples = plan.shot.channels.front().codes.size();
  ASSERT_LE(samples, records.front().size());
  for (std::size_t g = 0; g < 2; ++g) {
    const auto end = records[g].begin() + static_cast<std::ptrdiff_t>(samples);
    const auto [low, high] = std::minmax_element(records[g].begin(), end);
    EXPECT_NEAR(plan.gauges[g].highest_strain, *high, 2e-3 * *high);
    EXPECT_NEAR(plan.gauges[g].lowest_strain, *low, 2e-3 * *high);
    EXPECT_EQ(plan.gauges[g].name, model.bench().gauges[g].name);
  }

  // Until the specimen lets go: from then on nothing pulls at the one that is solved.
  const SpecimenHistory solved = solved_specimen(model);
  const Reduction& r = plan.specimen;
  ASSERT_GE(r.time_s.back(), 0.9 * model.pulse_s);
  std::size_t held = 1;
  while (held < r.time_s.size() && r.time_s[held] < model.pulse_s) {
    ++held;
  }
  EXPECT_LT(apart(r, r.strain, held, solved, solved.strain), 2e-3);
  EXPECT_LT(apart(r, r.stress_Pa, held, solved, solved.stress_Pa), 0.01);
  EXPECT_LT(apart(r, r.strain_rate_per_s, held, solved, solved.strain_rate_per_s), 0.02);
  const double most = *std::max_element(solved.strain.begin(), solved.strain.end());
  EXPECT_NEAR(plan.summary.peak_strain, most, 2e-3 * most);
}

INSTANTIATE_TEST_SUITE_P(PaperBench, ForetoldShot,
                         ::testing::Values(PlannedShape{170e-6, 40e-6},
                                           PlannedShape{170e-6, 6.85e-6},
                                           PlannedShape{250e-6, 6.85e-6},
                                           PlannedShape{500e-6, 40e-6}, PlannedShape{700e-6, 40e-6},
                                           PlannedShape{700e-6, 5e-6}, PlannedShape{700e-6, 2e-6}));

TEST(PlanShot, SaysWhereAndWhenTheSpecimenAnswers) {
  LinearShpb model;
  model.massless = false;
  const ShotPlan plan = planned(model, model.bench());
  ASSERT_TRUE(plan.reduction.quality.reducible);
  EXPECT_TRUE(plan.quotable.any);
  EXPECT_TRUE(plan.equilibrium.any);
  EXPECT_NEAR(plan.window_s, 273e-6, 2e-6);  // physics.md
  EXPECT_NEAR(plan.returns_s, 1.4 / 2190.0, 2e-6);
  EXPECT_NEAR(plan.specimen_transit_s, 0.004 / std::sqrt(65.5e6 / 1140.0), 0.1e-6);
}

// Without a mass both faces would agree from the first moment on.
TEST(PlanShot, TakesTheSpecimensDensityFromItsMaterialWhereTheBenchFilesNone) {
  const LinearShpb model;
  Bench bench = model.bench();
  bench.specimen->density_kg_m3 = core().density_kg_m3;
  const ShotPlan filed = planned(model, bench);
  bench.specimen->density_kg_m3.reset();
  const ShotPlan plan = planned(model, bench);
  EXPECT_GT(plan.equilibrium.from_s, plan.specimen_transit_s);
  EXPECT_EQ(plan.equilibrium.from_s, filed.equilibrium.from_s);
}

// What hides the push from a reduction hides nothing from the plan.
TEST(PlanShot, ForetellsTheSpecimenWhereTheBarsAreTooShortToSeeIt) {
  LinearShpb model;
  model.massless = false;
  model.pulse_s = 500e-6;
  const SpecimenHistory solved = solved_specimen(model);
  const ShotPlan plan = planned(model, model.bench());
  const double most = *std::max_element(solved.strain.begin(), solved.strain.end());
  EXPECT_NEAR(plan.summary.peak_strain, most, 0.01 * most);
  EXPECT_EQ(plan.reduction.quality.find("window_overlap")->verdict, Verdict::fail);
  EXPECT_GT(std::abs(summarise(plan.reduction).peak_strain - most), 0.5 * most);
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
  const Quality& quality = planned(model, model.bench()).reduction.quality;
  EXPECT_FALSE(quality.reducible) << "no gauge sees the rise";
  EXPECT_NE(quality.reason.find("too short for this pulse"), std::string::npos) << quality.reason;
  EXPECT_FALSE(quality.mend.empty());
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

// On an elastic bar a wave's strain is its force over EA, however fast it rises.
TEST(Pulse, OfAStrainOnAnElasticBarHasTheForceOfThatStrain) {
  LinearShpb model;
  model.input = {7850.0, 206e9};
  const Bench bench = model.bench();
  const double expected = 206e9 * std::numbers::pi * 0.0075 * 0.0075 * 1e-3;
  for (const double rise_s : {0.0, 40e-6, 5e-6, 1e-6, 1e-8}) {
    const PlannedPulse pulse = pulse_of_strain(bench, paper_pmma(), 1e-3, 700e-6, rise_s);
    EXPECT_NEAR(pulse.step_force_N.front(), expected, 2e-3 * expected) << rise_s;
  }
}

// On a viscoelastic bar it creeps to that and is damped on the way: held against a bar so long that
// nothing is back at the gauge before the pulse has passed.
TEST(Pulse, OfAStrainOnAViscoelasticBarMakesThatStrainAtTheGauge) {
  for (const double rise_s : {40e-6, 5e-6, 2e-6}) {
    LinearShpb model;
    model.input_length_m = 2.0;
    model.pulse_s = 700e-6;
    model.ramp_s = rise_s;
    model.record_s = 1.5e-3;
    const std::vector<double> first = model.solve().front();
    const double strain = *std::max_element(first.begin(), first.end());
    const PlannedPulse pulse =
        pulse_of_strain(model.bench(), paper_pmma(), strain, model.pulse_s, rise_s);
    EXPECT_NEAR(pulse.step_force_N.front(), force_N(model), 1e-3 * force_N(model)) << rise_s;
  }
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

// Steel on PMMA: 2 L over the speed in steel, v Z Z' / (Z + Z') at first.
TEST(Pulse, OfAStrikerOfAnotherMaterialTakesItsModulus) {
  const LinearShpb model;
  Bench bench = model.bench();
  bench.striker = Striker{Measured{0.1}, Measured{0.01}, Measured{7800.0}};
  EXPECT_THROW((void)pulse_of_striker(bench, paper_pmma(), 5.0, 5e-6), InputError);
  bench.striker->youngs_modulus_Pa = Measured{200e9};
  const PlannedPulse pulse = pulse_of_striker(bench, paper_pmma(), 5.0, 5e-6);
  EXPECT_NEAR(pulse.step_s, 2.0 * 0.1 / std::sqrt(200e9 / 7800.0), 1e-12);
  const double of_striker = 0.25 * std::numbers::pi * 0.01 * 0.01 * std::sqrt(200e9 * 7800.0);
  const double of_bar = bench.input.area_m2() * std::sqrt(1180.0 * 5.66e9);
  EXPECT_NEAR(pulse.step_force_N.front(), 5.0 * of_striker * of_bar / (of_striker + of_bar), 1e-3);
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

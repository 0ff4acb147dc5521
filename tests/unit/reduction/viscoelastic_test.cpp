// The paper's bench solved in the time domain, on a staggered grid with an internal strain per cell
// (the simulated digitiser's model), against the reduction, which works with transforms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/simulated/bench_model.hpp"
#include "processing/reduction/reducer.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky {
namespace {

constexpr double kStep_s = 0.1e-6;
constexpr std::size_t kStepsPerSample = 10;
constexpr std::size_t kSteps = 37'000;
constexpr std::size_t kPreSamples = 400;
constexpr double kBarLength_m = 0.7;
constexpr double kBarDiameter_m = 0.015;
constexpr double kSpecimenDiameter_m = 0.012;
constexpr RodMaterial kPmma{
    .density_kg_m3 = 1180, .E1_Pa = 5.66e9, .E2_Pa = 37.0e9, .eta2_Pa_s = 1.81e6};
constexpr RodMaterial kCore{
    .density_kg_m3 = 1140, .E1_Pa = 121e6, .E2_Pa = 143e6, .eta2_Pa_s = 2860};
constexpr RodMaterial kCover{
    .density_kg_m3 = 960, .E1_Pa = 987e6, .E2_Pa = 452e6, .eta2_Pa_s = 6020};

double circle_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

struct Solved {
  Shot shot;
  SpecimenHistory truth;
  double front_arrival_s = 0.0;  ///< of the very front at interface A, on the shot's clock
};

Bench paper_bench(double specimen_length_m) {
  Bench bench = testing::ElasticShpb{}.bench();
  bench.input.length_m = {kBarLength_m};
  bench.input.diameter_m = {kBarDiameter_m};
  bench.input.density_kg_m3 = {kPmma.density_kg_m3};
  bench.input.youngs_modulus_Pa.reset();
  bench.output = bench.input;
  bench.gauges[0].position_m = {0.4};
  bench.gauges[1].position_m = {0.05};
  bench.specimen = Specimen{.length_m = {specimen_length_m}, .diameter_m = {kSpecimenDiameter_m}};
  return bench;
}

Solved solve(const RodMaterial& material, double length_m, double noise_rms = 0.0,
             unsigned seed = 1) {
  const RodShape bar{kBarLength_m, circle_m2(kBarDiameter_m), kPmma};
  BenchModel model;
  model.input = bar;
  model.specimen = RodShape{length_m, circle_m2(kSpecimenDiameter_m), material};
  model.output = bar;
  model.pulse.peak_force_N = kPmma.E1_Pa * bar.area_m2 * 1e-3;
  model.gauges = {{RodId::input, 0.4}, {RodId::output, 0.05}};
  const BenchHistory history = run_bench(model, kStep_s, kSteps);
  std::vector<std::vector<double>> records;
  for (const auto& strain : history.gauge_strain) {
    records.emplace_back(kPreSamples, 0.0);
    for (std::size_t n = 0; n < strain.size(); n += kStepsPerSample) {
      records.back().push_back(strain[n]);
    }
  }
  Solved solved;
  solved.shot = testing::digitise(paper_bench(length_m), records, noise_rms,
                                  noise_rms > 0.0 ? 16 : 24, 0.01, seed);
  solved.truth = *history.specimen;
  solved.front_arrival_s = kPreSamples * 1e-6 + kBarLength_m / kPmma.front_speed_m_per_s();
  return solved;
}

/// Largest difference as a share of the truth's largest value, on the record's own clock.
double worst(const Reduction& r, const std::vector<double>& reduced, const Solved& solved,
             const std::vector<double>& exact) {
  double largest = 0.0;
  double difference = 0.0;
  for (std::size_t n = 0; n < reduced.size(); ++n) {
    const double t = r.time_s[n] + r.arrival_s - solved.front_arrival_s;
    const double index = (t - solved.truth.time_s.front()) / kStep_s;
    const auto i = static_cast<std::size_t>(index);
    const double share = index - static_cast<double>(i);
    const double expected = exact[i] * (1.0 - share) + exact[i + 1] * share;
    largest = std::max(largest, std::abs(expected));
    difference = std::max(difference, std::abs(reduced[n] - expected));
  }
  return difference / largest;
}

double check_value(const Reduction& r, const std::string& name) {
  for (const Check& check : r.quality.checks) {
    if (check.name == name) {
      return check.value;
    }
  }
  throw std::out_of_range(name);
}

class PaperSpecimens : public ::testing::TestWithParam<std::pair<RodMaterial, double>> {};

TEST_P(PaperSpecimens, AreReducedToTheTimeDomainSolutionUntilTheFirstReturn) {
  const auto& [material, length_m] = GetParam();
  const Solved solved = solve(material, length_m);
  const Reduction r = Reducer().reduce(solved.shot);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  // The answer of these specimens outlasts the 364 us until the impacted end sends it back to the
  // gauge.
  EXPECT_GT(r.time_s.back(), 630e-6);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), 5e-4);
  EXPECT_LT(worst(r, r.force_back_N, solved, solved.truth.force_back_N), 2e-4);
  // One sample's worth of the incident pulse is uncertain where the specimen's answer begins to
  // hide it.
  EXPECT_LT(worst(r, r.force_front_N, solved, solved.truth.force_front_N), 5e-3);
  EXPECT_LT(worst(r, r.strain_rate_per_s, solved, solved.truth.strain_rate_per_s), 5e-3);
}

INSTANTIATE_TEST_SUITE_P(CoreAndCover, PaperSpecimens,
                         ::testing::Values(std::pair{kCore, 0.004}, std::pair{kCore, 0.006},
                                           std::pair{kCover, 0.004}, std::pair{kCover, 0.006}));

TEST(PaperBench, FourMillimetresOfRubberAreInEquilibriumAndSixAreNot) {
  // physics.md: 4.5 to 5 %, 9 to 11 %, cover 3.4 %, for another pulse of the same length.
  const Reduction four = Reducer().reduce(solve(kCore, 0.004, 4e-6).shot);
  const Reduction six = Reducer().reduce(solve(kCore, 0.006, 4e-6).shot);
  const Reduction cover = Reducer().reduce(solve(kCover, 0.006, 4e-6).shot);
  EXPECT_NEAR(check_value(four, "equilibrium"), 0.05, 0.015);
  EXPECT_NEAR(check_value(six, "equilibrium"), 0.105, 0.02);
  EXPECT_NEAR(check_value(cover, "equilibrium"), 0.034, 0.01);
  EXPECT_EQ(four.quality.verdict(), Verdict::pass);
  EXPECT_EQ(six.quality.verdict(), Verdict::warn);
}

TEST(PaperBench, ABarModelThatIsOffShows) {
  const Shot shot = solve(kCore, 0.004).shot;
  ReductionOptions options;
  options.bar_model = paper_pmma();
  options.bar_model->E1_Pa.value *= 0.95;
  const Reduction right = Reducer().reduce(shot);
  const Reduction off = Reducer(options).reduce(shot);
  EXPECT_LT(check_value(right, "equilibrium"), 0.07);
  EXPECT_GT(check_value(off, "equilibrium"), 0.10);
}

TEST(PaperBench, SaysWhichBarModelWasAssumed) {
  Shot shot = solve(kCore, 0.004).shot;
  EXPECT_NE(Reducer().reduce(shot).bar_model.find("assumed"), std::string::npos);
  shot.bar_model = paper_pmma();
  shot.bar_model->source = "identified in May";
  EXPECT_EQ(Reducer().reduce(shot).bar_model, "identified in May");
}

}  // namespace
}  // namespace kolsky

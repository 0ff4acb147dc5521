#include "processing/impact/bench_impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/impact/filter.hpp"
#include "processing/impact/impact.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace kolsky::impact {
namespace {

using kolsky::testing::paper_bench;
using kolsky::testing::paper_core;
using kolsky::testing::paper_cover;

TEST(BenchImpact, TakesWhatTheBenchSays) {
  const ImpactModel model =
      impact_on(paper_bench(), {paper_core()}, {paper_cover()}, TargetKind::dashpot, 40.3);
  ASSERT_EQ(model.layers.size(), 2U);
  EXPECT_EQ(model.layers[0].outer_diameter_m, 0.03565);
  EXPECT_EQ(model.layers[0].solid.density_kg_m3, 1140.0);
  EXPECT_NEAR(model.target.impedance_kg_per_s(), 12795.0, 5.0);
  EXPECT_EQ(model.friction, 0.3);
}

TEST(BenchImpact, MassThatGeometryDoesNotGiveIsRefusedUnlessScalingIsAskedFor) {
  Bench bench = paper_bench();
  bench.ball->core_diameter_m.value = 0.038;
  try {
    (void)impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::dashpot, 40.3);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "ball.mass_kg");
    EXPECT_NE(error.problem().find("44.3"), std::string::npos) << error.what();
    EXPECT_NE(error.mend().find("scale_density"), std::string::npos);
  }
  bench.ball->scale_density = true;
  const MassCheck mass = check_mass(*bench.ball, paper_core(), paper_cover());
  EXPECT_NEAR(mass.density_scale, 43.4 / 44.31, 2e-4);
  const ImpactModel model =
      impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::dashpot, 40.3);
  EXPECT_NEAR(model.layers[0].solid.density_kg_m3, 1140.0 * mass.density_scale, 1e-9);
}

TEST(BenchImpact, ScaleDensityDoesNothingWhereTheMassFits) {
  Bench bench = paper_bench();
  bench.ball->scale_density = true;
  EXPECT_EQ(check_mass(*bench.ball, paper_core(), paper_cover()).density_scale, 1.0);
}

TEST(BenchImpact, AFiledDeviationExcusesTheMass) {
  Bench bench = paper_bench();
  bench.ball->core_diameter_m.value = 0.038;
  bench.ball->mass_kg = Measured{0.0434, 0.0005};
  EXPECT_EQ(check_mass(*bench.ball, paper_core(), paper_cover()).density_scale, 1.0);
}

TEST(BenchImpact, RefusesABarWithoutAModulusUnlessTheTargetIsRigid) {
  Bench bench = paper_bench();
  bench.input.youngs_modulus_Pa.reset();
  EXPECT_THROW((void)impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::dashpot, 40.3),
               InputError);
  EXPECT_NO_THROW((void)impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::rigid, 40.3));
  bench.ball.reset();
  EXPECT_THROW((void)impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::rigid, 40.3),
               InputError);
}

/// What a ball does is no matter of how fast the gauges are read.
TEST(BenchImpact, NumbersDoNotDependOnTheSamplingRate) {
  std::vector<ImpactHistory> histories;
  for (const double rate_Hz : {20e3, 1e6, 1e9}) {
    Bench bench = paper_bench();
    bench.sampling_frequency_Hz = {rate_Hz, 0.0};
    ImpactModel model =
        impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::dashpot, 40.3);
    model.elements = 300;
    histories.push_back(simulate(model));
  }
  for (const ImpactHistory& history : histories) {
    EXPECT_EQ(history.peak_force_N, histories[1].peak_force_N);
    EXPECT_EQ(history.contact_time_s, histories[1].contact_time_s);
  }
}

TEST(BenchImpact, ABarWithoutABulkModulusIsRefusedByItsKey) {
  Bench bench = paper_bench();
  bench.input.poisson_ratio = {0.5};
  try {
    (void)impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::dashpot, 40.3);
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "bars.input.poisson_ratio");
  }
  EXPECT_NO_THROW((void)impact_on(bench, {paper_core()}, {paper_cover()}, TargetKind::rigid, 40.3));
}

// F = 6 t (s in us), as means over intervals: 0 to 1/2 as over a whole one, then round 1, 2, 3.
TEST(MeansAt, KeepTheSumAndAreTheMeansOfTheFunction) {
  const std::vector<double> means{0.75, 6.0, 12.0, 18.0};
  const auto at = [&](double wanted_s) { return means_at(means, 1e-6, wanted_s); };
  EXPECT_EQ(at(1e-6), means);
  // Sums to 0.5, 1.5, 2.5 and 3.5 us: 0.75, 6.75, 18.75, 36.75; between them on a line.
  const std::vector<double> coarse = at(2e-6);
  ASSERT_EQ(coarse.size(), 3U);
  EXPECT_NEAR(coarse[0], 1.5 + 0.375, 1e-9) << "within an interval its mean is all there is";
  EXPECT_NEAR(coarse[1], 12.0, 1e-9);
  for (const double wanted_s : {2e-6, 0.5e-6, 0.3e-6, 1.7e-6}) {
    const std::vector<double> own = at(wanted_s);
    EXPECT_NEAR(std::accumulate(own.begin(), own.end(), 0.0) * wanted_s, 36.75e-6, 1e-15)
        << wanted_s;
  }
}

TEST(ValuesAt, LieOnTheLineBetweenThem) {
  const std::vector<double> line{0.0, 2.0, 4.0, 6.0};
  EXPECT_EQ(values_at(line, 1e-6, 1e-6), line);
  const std::vector<double> fine = values_at(line, 1e-6, 0.25e-6);
  ASSERT_GE(fine.size(), 12U);
  for (std::size_t n = 0; n <= 12; ++n) {
    EXPECT_NEAR(fine[n], 0.5 * static_cast<double>(n), 1e-9);
  }
  EXPECT_EQ(fine.back(), 6.0) << "the last one holds";
  EXPECT_EQ(fine.size(), means_at(line, 1e-6, 0.25e-6).size());
}

TEST(LowPass, HasItsCutoffAndKeepsTheMean) {
  constexpr double kInterval_s = 1e-6;
  std::vector<double> wave(4000);
  for (std::size_t n = 0; n < wave.size(); ++n) {
    wave[n] = 3.0 + std::cos(2.0 * std::numbers::pi * 50e3 * kInterval_s * static_cast<double>(n));
  }
  const std::vector<double> passed = low_passed(wave, kInterval_s, 50e3);
  EXPECT_NEAR(passed[2000] - 3.0, std::sqrt(0.5), 2e-3);
  EXPECT_NEAR(std::accumulate(passed.begin(), passed.end(), 0.0) / 4000.0, 3.0, 1e-3);
}

TEST(MeanRate, OfALineIsItsSlopeToTheEnds) {
  std::vector<double> line(50);
  for (std::size_t n = 0; n < line.size(); ++n) {
    line[n] = 7.0 * static_cast<double>(n);
  }
  for (const double rate : mean_rate(line, 1e-6, 20e-6)) {
    EXPECT_NEAR(rate, 7e6, 1e-3);
  }
}

}  // namespace
}  // namespace kolsky::impact

#include "processing/impact/bench_impact.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/impact/filter.hpp"
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

// A bar with four gauges, solved in the time domain on a staggered grid, given to the fit.
#include "processing/identification/bar_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "drivers/simulated/bench_model.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/parameter_budget.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky {
namespace {

constexpr double kStep_s = 0.1e-6;
constexpr std::size_t kStepsPerSample = 10;
constexpr std::size_t kPreSamples = 400;
constexpr double kDiameter_m = 0.020;

Bench bar_bench() {
  Bench bench;
  bench.kind = BenchKind::bar;
  bench.sampling_frequency_Hz = {1e6, 0.0};
  bench.input.length_m = {2.0};
  bench.input.diameter_m = {kDiameter_m};
  bench.input.density_kg_m3 = {1180.0};
  bench.input.poisson_ratio = {0.36};
  for (int i = 0; i < 4; ++i) {
    Gauge gauge;
    gauge.name = "g" + std::to_string(i + 1);
    gauge.bar = "input";
    gauge.position_m = {0.1 + 0.2 * i};
    gauge.unit = "strain";
    bench.gauges.push_back(gauge);
  }
  return bench;
}

std::vector<std::vector<double>> records_of(const RodMaterial& material, double peak_strain) {
  const double area_m2 = std::numbers::pi * kDiameter_m * kDiameter_m / 4.0;
  BenchModel model;
  model.input = RodShape{2.0, area_m2, material};
  model.pulse = {
      .peak_force_N = material.E1_Pa * area_m2 * peak_strain, .duration_s = 91e-6, .ramp_s = 25e-6};
  for (int i = 0; i < 4; ++i) {
    model.gauges.push_back({RodId::input, 0.1 + 0.2 * i});
  }
  const BenchHistory history = run_bench(model, kStep_s, 36'960);
  std::vector<std::vector<double>> records;
  for (const auto& strain : history.gauge_strain) {
    records.emplace_back(kPreSamples, 0.0);
    for (std::size_t n = 0; n < strain.size(); n += kStepsPerSample) {
      records.back().push_back(strain[n]);
    }
  }
  return records;
}

constexpr RodMaterial kPmma{
    .density_kg_m3 = 1180, .E1_Pa = 5.66e9, .E2_Pa = 37.0e9, .eta2_Pa_s = 1.81e6};

std::vector<Shot> shots_of(std::size_t count) {
  const auto records = records_of(kPmma, 2e-3);
  std::vector<Shot> shots;
  for (unsigned seed = 1; seed <= count; ++seed) {
    shots.push_back(testing::digitise(bar_bench(), records, 4e-6, 16, 0.01, seed));
  }
  return shots;
}

TEST(FitBar, FindsTheMaterialWithinItsDeviations) {
  const BarFit fit = fit_bar(shots_of(4), {.theory = WaveTheory::elementary});
  const std::vector<double> truth = {kPmma.E1_Pa, kPmma.E2_Pa, kPmma.eta2_Pa_s};
  ASSERT_EQ(fit.parameters.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(fit.parameters[i].value, truth[i], 4.0 * fit.parameters[i].sd)
        << fit.parameters[i].name;
  }
  EXPECT_NEAR(fit.chi2_reduced, 1.0, 0.08);
  // physics.md: ten shots with four gauges allow E1 0.003 to 0.006 %, E2 0.03 to 0.17 %, eta2 0.05
  // to 0.12 %.
  EXPECT_LT(fit.parameters[0].sd, 1e-4 * truth[0]);
  EXPECT_LT(fit.parameters[1].sd, 2e-3 * truth[1]);
  EXPECT_LT(fit.parameters[2].sd, 2e-3 * truth[2]);
}

TEST(FitBar, TheDataTellWhichWaveTheoryTheyObey) {
  const auto shots = shots_of(1);
  const BarFit right = fit_bar(shots, {.theory = WaveTheory::elementary});
  const BarFit wrong = fit_bar(shots, {.theory = WaveTheory::love});
  EXPECT_NEAR(right.chi2_reduced, 1.0, 0.1);
  EXPECT_GT(wrong.chi2_reduced, 5.0);
  EXPECT_GT(right.log_evidence, wrong.log_evidence + 1000.0);
}

/// A bench that is off by a filed deviation moves the fit by what the budget says of it.
TEST(FitBar, ItsBudgetIsWhatABenchThatIsOffDoes) {
  std::vector<Shot> shots = shots_of(2);
  for (Shot& shot : shots) {
    shot.bench.input.density_kg_m3.sd = 5.0;
    shot.bench.gauges[0].position_m.sd = 0.2e-3;
  }
  const BarFit fit = fit_bar(shots, {.theory = WaveTheory::elementary});
  const auto budget = parameter_budget(fit.parameters, fit.by_bench, fit.bench);
  ASSERT_EQ(budget.size(), 3U);
  EXPECT_EQ(budget[0].source, "bar densities");  // 0.4 %
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(budget[0].share[p] + budget[1].share[p] + budget[2].share[p], 1.0, 1e-9);
    EXPECT_NEAR(budget[0].sd[p] / fit.parameters[p].value, 5.0 / 1180.0, 1e-4);
  }
  for (Shot& shot : shots) {
    shot.bench.gauges[0].position_m.value += 0.2e-3;
  }
  const BarFit off = fit_bar(shots, {.theory = WaveTheory::elementary});
  const auto positions = std::find_if(budget.begin(), budget.end(), [](const BudgetLine& line) {
    return line.source == "gauge positions";
  });
  ASSERT_NE(positions, budget.end());
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(std::abs(off.parameters[p].value - fit.parameters[p].value), positions->sd[p],
                0.05 * positions->sd[p] + 0.02 * fit.parameters[p].sd)
        << fit.parameters[p].name;
  }
}

TEST(FitBar, AnotherKindOfBenchIsRefused) {
  auto shots = shots_of(1);
  shots.front().bench.kind = BenchKind::shpb;
  EXPECT_THROW((void)fit_bar(shots, {}), InputError);
  EXPECT_THROW((void)fit_bar({}, {}), InputError);
}

}  // namespace
}  // namespace kolsky

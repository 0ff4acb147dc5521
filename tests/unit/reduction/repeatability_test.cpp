// The same shot gives the same bits, whatever the program has transformed before.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "processing/reduction/reducer.hpp"
#include "processing/waves/transform.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky {
namespace {

TEST(Repeatability, OtherLengthsPlannedBeforeChangeNoBit) {
  const testing::ElasticShpb model;
  const Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 1);
  const Reduction alone = Reducer().reduce(shot);
  for (std::size_t samples = 500; samples < 5000; samples += 173) {
    const DampedTransform other(samples, 1e-6);
  }
  const Reduction after = Reducer().reduce(shot);
  EXPECT_EQ(alone.stress_Pa, after.stress_Pa);
  EXPECT_EQ(alone.strain, after.strain);
  Reducer used;
  testing::ElasticShpb longer = model;
  longer.duration_s = 2.1e-3;
  longer.gauge_to_A_m = 0.3;
  (void)used.reduce(longer.shot(longer.solve(), 1e-6, 16, 0.01, 2));
  EXPECT_EQ(used.reduce(shot).stress_Pa, alone.stress_Pa);
}

/// Bars that take their moduli from a bar model: steel, with a little damping.
Material damped_steel() {
  Material steel;
  steel.density_kg_m3 = {7850.0};
  steel.E1_Pa() = {206e9};
  steel.E2_Pa() = {9e12};
  steel.eta2_Pa_s() = {2e7};
  return steel;
}

/// Exact waves are what takes time to tabulate.
ReductionOptions exact_waves(const Material& bars) {
  ReductionOptions options;
  options.theory = WaveTheory::exact;
  options.bar_model = bars;
  return options;
}

Shot shot_of(double noise_strain, unsigned seed) {
  static const testing::ElasticShpb model;
  static const auto records = model.solve();
  Shot shot = model.shot(records, noise_strain, 16, 0.01, seed);
  shot.bench.input.youngs_modulus_Pa.reset();
  shot.bench.output->youngs_modulus_Pa.reset();
  return shot;
}

void expect_same_bits(const Reduction& a, const Reduction& b, const std::string& what) {
  ASSERT_TRUE(a.quality.reducible) << what << ": " << a.quality.reason;
  ASSERT_FALSE(a.time_s.empty()) << what;
  EXPECT_EQ(a.time_s, b.time_s) << what;
  EXPECT_EQ(a.stress_Pa, b.stress_Pa) << what;
  EXPECT_EQ(a.strain, b.strain) << what;
  EXPECT_EQ(a.force_front_N, b.force_front_N) << what;
}

TEST(Repeatability, ABenchKeepsItsTablesHoweverFarUpItsShotsReach) {
  const ReductionOptions options = exact_waves(damped_steel());
  Reducer used(options);
  // The noise decides up to where: tables are made longer, and used in part.
  for (const double noise_strain : {2e-5, 1e-6, 2e-5, 4e-6}) {
    for (const unsigned seed : {1U, 2U}) {
      const Shot shot = shot_of(noise_strain, seed);
      expect_same_bits(used.reduce(shot), Reducer(options).reduce(shot),
                       std::to_string(noise_strain));
    }
  }
  EXPECT_EQ(used.tables_made(), 1U);
}

TEST(Repeatability, WhateverChangesTheWavesMakesTablesAnew) {
  const Shot shot = shot_of(4e-6, 1);
  const ReductionOptions options = exact_waves(damped_steel());
  struct Change {
    const char* what;
    std::function<void(Shot&, ReductionOptions&)> make;
  };
  for (const Change& change : {
           Change{"diameter", [](Shot&s, auto&) { s.bench.input.diameter_m = {0.0202}; }},
           Change{"length", [](Shot&s, auto&) { s.bench.input.length_m = {1.01}; }},
           Change{"output bar's length", [](Shot&s, auto&) { s.bench.output->length_m = {1.01}; }},
           Change{"density", [](Shot&s, auto&) { s.bench.output->density_kg_m3 = {7800.0}; }},
           Change{"Poisson's ratio", [](Shot&s, auto&) { s.bench.output->poisson_ratio = {0.28}; }},
           Change{"gauge", [](Shot&s, auto&) { s.bench.gauges[1].position_m = {0.31}; }},
           Change{"far end", [](Shot&s, auto&) { s.bench.output->far_end = FarEnd::matched; }},
           Change{"filed modulus",
                  [](Shot&s, auto&) { s.bench.input.youngs_modulus_Pa = {205e9}; }},
           Change{"second branch",
                  [](Shot&, ReductionOptions&o) {
                    o.bar_model->solid = SolidKind::two_kelvin;
                    o.bar_model->parameters = {{206e9}, {9e12}, {2e7}, {1e13}, {2e8}};
                  }},
           // What another temperature comes to.
           Change{"bar model", [](Shot&, ReductionOptions&o) { o.bar_model->E2_Pa() = {8e12}; }},
           Change{"damping", [](Shot&, ReductionOptions&o) { o.bar_model->eta2_Pa_s() = {3e7}; }},
           Change{"rate", [](Shot&s, auto&) { s.rate = SampleRate::from_Hz(0.99e6); }},
           Change{"theory", [](Shot&, ReductionOptions&o) { o.theory = WaveTheory::love; }},
       }) {
    Shot changed = shot;
    ReductionOptions other = options;
    change.make(changed, other);
    Reducer used(options);
    const Reduction before = used.reduce(shot);
    used.set_options(other);
    const Reduction after = used.reduce(changed);
    EXPECT_EQ(used.tables_made(), 2U) << change.what;
    expect_same_bits(after, Reducer(other).reduce(changed), change.what);
    EXPECT_NE(after.stress_Pa, before.stress_Pa) << change.what;
    used.set_options(options);
    expect_same_bits(used.reduce(shot), before, change.what);
    EXPECT_EQ(used.tables_made(), 2U) << change.what << ": those of the first are kept";
  }
}

TEST(Repeatability, TheLastFourBenchesKeepTheirTables) {
  const ReductionOptions options = exact_waves(damped_steel());
  Reducer used(options);
  std::vector<Shot> shots;
  for (int n = 0; n < 5; ++n) {
    shots.push_back(shot_of(4e-6, 1));
    shots.back().bench.input.diameter_m = {0.020 + 1e-4 * n};
  }
  const auto reduced = [&](std::initializer_list<std::size_t> order) {
    for (const std::size_t n : order) {
      expect_same_bits(used.reduce(shots[n]), Reducer(options).reduce(shots[n]), std::to_string(n));
    }
    return used.tables_made();
  };
  EXPECT_EQ(reduced({0, 1, 2, 3}), 4U);
  EXPECT_EQ(reduced({2, 3, 1, 0, 3}), 4U);
  // The fifth takes the place of the one that was not used for longest.
  EXPECT_EQ(reduced({4}), 5U);
  EXPECT_EQ(reduced({0, 3, 1, 4}), 5U);
  EXPECT_EQ(reduced({2}), 6U);
}

}  // namespace
}  // namespace kolsky

// Records whose level moves, which the quiet before the pulse shows.
#include "processing/reduction/quiet_drift.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "processing/reduction/reducer.hpp"
#include "tests/generators/elastic_shpb.hpp"

namespace kolsky {
namespace {

using testing::digitise;
using testing::ElasticShpb;

constexpr double kNoise = 4e-6;

/// A millisecond of quiet, then a pulse.
ElasticShpb model() {
  ElasticShpb model;
  model.foot_at_gauge_s = 1e-3;
  model.duration_s = 2e-3;
  return model;
}

/// A shot whose output gauge reads a hum as well.
Shot humming(double hum, double phase, double noise_rms = kNoise) {
  const ElasticShpb bench = model();
  const auto records = bench.solve();
  std::vector<double> output = records.output_strain;
  for (std::size_t n = 0; n < output.size(); ++n) {
    const double time_s = static_cast<double>(n) / bench.sampling_frequency_Hz;
    output[n] += hum * std::cos(2.0 * std::numbers::pi * 50.0 * time_s + phase);
  }
  return digitise(bench.bench(), {records.input_strain, output}, noise_rms, 16, 0.01, 7);
}

/// Nothing but noise and a pulse as high as a thousand of it; `memory` of the last sample is kept.
Shot quiet_then_pulse(double memory, unsigned seed) {
  const ElasticShpb model;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, kNoise * std::sqrt(1.0 - memory * memory));
  std::vector<std::vector<double>> strains(2);
  for (auto& strain : strains) {
    double last = kNoise * std::normal_distribution<double>()(random);
    for (std::size_t n = 0; n < 1500; ++n) {
      last = memory * last + normal(random);
      strain.push_back(last + (n >= 400 && n < 600 ? 250.0 * kNoise : 0.0));
    }
  }
  return digitise(model.bench(), strains, 0.0, 16, 0.01, seed);
}

TEST(QuietDrift, OfAHumIsWarnedOfAndItsGaugeNamed) {
  const Reduction r = Reducer().reduce(humming(20e-6, 1.57));  // steepest
  const Check* check = r.quality.find("drift");
  ASSERT_NE(check, nullptr);
  EXPECT_EQ(check->verdict, Verdict::warn);
  EXPECT_EQ(check->text.find("g2 "), 0U) << check->text;
}

TEST(QuietDrift, IsAsLargeAsWhatTheHumDoesIfItGoesOnAsBefore) {
  const auto strain = model().solve().output_strain;
  const double peak = *std::max_element(strain.begin(), strain.begin() + 1600);
  const auto check = quiet_drift(humming(20e-6, 1.57, 0.5e-6), 980, 1600);
  ASSERT_TRUE(check);
  // 20 microstrain at 314 rad/s, from the quiet part's middle on, which bends it by 2 %.
  EXPECT_NEAR(check->value, 20e-6 * 314.2 * (1600e-6 - 490e-6) / peak, 0.06 * check->value);
}

TEST(QuietDrift, IsNotMentionedWhereThereIsNone) {
  EXPECT_EQ(Reducer().reduce(humming(0.0, 0.0)).quality.find("drift"), nullptr);
}

TEST(QuietDrift, IsNotSeenInNoiseOfAnyColour) {
  for (const double memory : {0.0, 0.9, 0.97}) {
    int warned = 0;
    for (unsigned seed = 1; seed <= 400; ++seed) {
      warned += quiet_drift(quiet_then_pulse(memory, seed), 390, 900) ? 1 : 0;
    }
    EXPECT_LE(warned, 8) << memory;  // of 800 records
  }
}

TEST(QuietDrift, OfTooFewSamplesIsNotAsked) {
  EXPECT_FALSE(quiet_drift(humming(20e-6, 1.57), 63, 900));
}

}  // namespace
}  // namespace kolsky

// What a reduction says of its own worth, on histories made by hand and on solved benches.
#include "processing/reduction/validity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "processing/reduction/reducer.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/linear_shpb.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::check_of;

/// Faces that differ by half until 40 us and by 2 % from then on; loaded until 100 us.
Reduction by_hand() {
  Reduction r;
  for (int n = 0; n <= 200; ++n) {
    const double loaded = std::min(n, 100);
    const double apart = n < 40 ? 0.25 : 0.01;
    r.time_s.push_back(1e-6 * n);
    r.strain.push_back(1e-3 * (n <= 100 ? n : 200 - n));
    r.strain_rate_per_s.push_back(n <= 100 ? 1e3 : -1e3);
    r.force_front_N.push_back(loaded * (1.0 + apart));
    r.force_back_N.push_back(loaded * (1.0 - apart));
    r.stress_Pa.push_back(loaded);
  }
  r.quality.reducible = true;
  return r;
}

TEST(Validity, QuotesTheLoadingFromWhereTheFacesAgree) {
  const Reduction r = by_hand();
  const auto apart = disagreement(r);
  ASSERT_EQ(apart.size(), r.time_s.size());
  EXPECT_TRUE(std::isnan(apart[0])) << "no force yet";
  EXPECT_NEAR(apart[20], 0.5, 0.02);
  EXPECT_NEAR(apart[70], 0.02, 0.002);
  const Quotable part = quotable_part(r);
  ASSERT_TRUE(part.any);
  // The moving window is 10 us long.
  EXPECT_NEAR(part.from_s, 44e-6, 3e-6);
  EXPECT_NEAR(part.to_s, 99e-6, 2e-6);
  EXPECT_NEAR(part.from_strain, 0.044, 0.003);
}

// Histories that are asked for beyond what the gauges tell drift, even to more strain of the other
// sign than there was in the loading.
TEST(Validity, QuotesNothingOfADriftThatFollows) {
  Reduction r = by_hand();
  for (std::size_t n = 150; n < r.strain.size(); ++n) {
    r.strain[n] = -0.05 - 5e-3 * static_cast<double>(n - 150);
    r.force_front_N[n] = r.force_back_N[n] = -10.0;
    r.stress_Pa[n] = -10.0;
  }
  const Quotable part = quotable_part(r);
  ASSERT_TRUE(part.any);
  EXPECT_NEAR(part.from_s, 44e-6, 3e-6);
  EXPECT_NEAR(part.to_s, 99e-6, 2e-6);
}

TEST(Validity, QuotesATensileLoadingToo) {
  Reduction r = by_hand();
  for (auto* history : {&r.strain, &r.stress_Pa, &r.force_front_N, &r.force_back_N}) {
    for (double& value : *history) {
      value = -value;
    }
  }
  EXPECT_NEAR(quotable_part(r).to_s, 99e-6, 2e-6);
}

TEST(Validity, QuotesNothingWhereTheFacesNeverAgree) {
  Reduction r = by_hand();
  for (double& force : r.force_front_N) {
    force *= 1.3;
  }
  EXPECT_FALSE(quotable_part(r).any);
  EXPECT_FALSE(quotable_part(r).text.empty());
  EXPECT_FALSE(quotable_part({}).any);
  EXPECT_TRUE(disagreement({}).empty());
}

Shot shot_of(const testing::LinearShpb& model, double noise) {
  return testing::digitise(model.bench(), model.solve(), noise, 16, 0.005, 1);
}

TEST(Validity, UsefulBandShrinksAsNoiseGrows) {
  testing::LinearShpb model;
  double before_Hz = 1e9;
  for (const double noise : {1e-6, 10e-6, 60e-6}) {
    const Shot shot = shot_of(model, noise);
    const Reduction r = Reducer().reduce(shot);
    const SpectralQuality quality = spectral_quality(shot, r);
    ASSERT_EQ(quality.frequency_Hz.size(), quality.input_dB.size());
    ASSERT_EQ(quality.frequency_Hz.size(), quality.output_dB.size());
    EXPECT_LT(quality.useful_band_Hz, before_Hz);
    before_Hz = quality.useful_band_Hz;
    if (noise > 50e-6) {
      // White noise of a known level: far above the pulse's band the level reads 0 dB.
      const auto last = quality.input_dB.end();
      EXPECT_NEAR(std::accumulate(last - 8, last, 0.0) / 8.0, 0.0, 3.0);
    }
  }
  EXPECT_TRUE(spectral_quality({}, {}).frequency_Hz.empty());
}

TEST(Validity, EnergyBalancesOnABenchAsFiledAndNotOnAnother) {
  testing::LinearShpb model;
  model.massless = false;
  Shot shot = shot_of(model, 4e-6);
  const Reduction right = Reducer().reduce(shot);
  EXPECT_LT(check_of(right, "energy_balance").value, 0.03);
  EXPECT_EQ(check_of(right, "energy_balance").verdict, Verdict::pass);
  shot.bench.gauges[1].unit = "V";
  shot.bench.gauges[1].strain_per_V = Measured{1.25};
  const Reduction wrong = Reducer().reduce(shot);
  EXPECT_EQ(check_of(wrong, "energy_balance").verdict, Verdict::warn);
}

TEST(Validity, TheBandIsHeldWhereTheBarsAreKnown) {
  const testing::LinearShpb model;
  const Shot shot = shot_of(model, 4e-6);
  ReductionOptions options;
  options.most_band_Hz = 6e3;
  const Reduction r = Reducer(options).reduce(shot);
  EXPECT_EQ(r.band_limit_Hz, 6e3);
  const Reduction wide = Reducer().reduce(shot);
  EXPECT_GT(wide.band_limit_Hz, 20e3);
  EXPECT_LT(check_of(wide, "band").value, 1e-3);
  EXPECT_GT(check_of(r, "band").value, check_of(wide, "band").value);
  EXPECT_GT(check_of(r, "band").value, 1e-3);
}

}  // namespace
}  // namespace kolsky

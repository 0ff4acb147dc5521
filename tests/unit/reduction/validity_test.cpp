// What a reduction says of its own worth, on histories made by hand and on solved benches.
#include "processing/reduction/validity.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "processing/reduction/loop_summary.hpp"
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

// A pull beyond the push, and a second push beyond both.
TEST(Validity, QuotesTheFirstLoadingOfSeveral) {
  Reduction r = by_hand();
  for (int n = 201; n <= 700; ++n) {
    const double phase = (n <= 450 ? -1.2 : 1.3) * (n <= 450 ? n - 200 : n - 450) / 250.0;
    r.time_s.push_back(1e-6 * n);
    r.strain.push_back(0.1 * phase);
    r.strain_rate_per_s.push_back(0.0);
    r.force_front_N.push_back(100.0 * phase);
    r.force_back_N.push_back(100.0 * phase);
    r.stress_Pa.push_back(100.0 * phase);
  }
  EXPECT_NEAR(quotable_part(r).to_s, 99e-6, 2e-6);
  EXPECT_NEAR(summarise(r).mean_strain_rate_per_s, 1e3, 1.0);
}

// Nothing comes back of a plastic strain: what ends the first loading is that the force is gone.
TEST(Validity, QuotesTheFirstLoadingOfWhatKeepsItsStrain) {
  Reduction r = by_hand();
  r.time_s.clear();
  for (auto* history :
       {&r.strain, &r.strain_rate_per_s, &r.stress_Pa, &r.force_front_N, &r.force_back_N}) {
    history->clear();
  }
  for (int n = 0; n <= 400; ++n) {
    const int pass = n % 200;
    const double loaded = pass > 100 ? 0.0 : 100.0;
    r.time_s.push_back(1e-6 * n);
    r.strain.push_back(0.1 * (n / 200) + 1e-3 * std::min(pass, 100) - (pass > 100 ? 2e-4 : 0.0));
    r.strain_rate_per_s.push_back(pass <= 100 ? 1e3 : 0.0);
    for (auto* history : {&r.stress_Pa, &r.force_front_N, &r.force_back_N}) {
      history->push_back(loaded);
    }
  }
  EXPECT_NEAR(quotable_part(r).to_s, 99e-6, 2e-6);
  EXPECT_NEAR(summarise(r).loading_s, 98e-6, 3e-6);
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

Check judged(const char* name, Verdict verdict) {
  Check check;
  check.name = name;
  check.verdict = verdict;
  check.text = "is not as it should be";
  return check;
}

TEST(Validity, QuotesNoCurveThatAnotherCheckPutsInDoubt) {
  for (const char* name : {"window_overlap", "energy_balance"}) {
    Reduction r = by_hand();
    r.quality.checks = {judged(name, Verdict::pass)};
    EXPECT_TRUE(quotable_part(r).any) << name;
    r.quality.checks = {judged(name, Verdict::warn)};
    EXPECT_FALSE(quotable_part(r).any) << name;
    EXPECT_NE(quotable_part(r).text.find("is not as it should be"), std::string::npos);
  }
  // Edges that the band rounds are no harm, a pulse that it lowers is.
  for (const double left_out : {0.05, 0.2}) {
    Reduction r = by_hand();
    r.quality.checks = {judged("band", Verdict::warn)};
    r.quality.checks.front().value = left_out;
    EXPECT_EQ(quotable_part(r).any, left_out < 0.1) << left_out;
  }
  // Waves told apart by more than time: what is left of the push is no harm.
  Reduction r = by_hand();
  r.separation = Separation::gauges;
  r.quality.checks = {judged("window_overlap", Verdict::warn)};
  EXPECT_TRUE(quotable_part(r).any);
}

TEST(Validity, SaysThatEquilibriumWasAssumed) {
  Reduction r = by_hand();
  r.separation = Separation::equilibrium;
  r.force_front_N = r.force_back_N;
  r.assumed_from_s = 60e-6;
  for (const double apart : disagreement(r)) {
    EXPECT_TRUE(std::isnan(apart)) << "nothing was compared";
  }
  const Quotable part = quotable_part(r);
  ASSERT_TRUE(part.any);
  EXPECT_TRUE(part.assumed);
  EXPECT_NEAR(part.from_s, 60e-6, 1e-6);
  EXPECT_NEAR(part.to_s, 99e-6, 2e-6);
  EXPECT_NE(part.text.find("assumed, not tested"), std::string::npos) << part.text;
  EXPECT_EQ(part.text.find("both faces carry the same force and"), std::string::npos);
  for (const double never : {150e-6, std::numeric_limits<double>::infinity()}) {
    r.assumed_from_s = never;
    EXPECT_FALSE(quotable_part(r).any);
    EXPECT_NE(quotable_part(r).text.find("assumed, not tested"), std::string::npos);
  }
  EXPECT_FALSE(quotable_part(by_hand()).assumed);
}

Shot shot_of(const testing::LinearShpb& model, double noise) {
  return testing::digitise(model.bench(), model.solve(), noise, 16, 0.005, 1);
}

// The core's relaxed modulus, 1 / (1/E1 + 1/E2), is the least that its waves can travel by, E1 the
// most.
TEST(Validity, EquilibriumIsAssumedAfterFourCrossings) {
  const testing::LinearShpb model;
  Shot shot = shot_of(model, 4e-6);
  ReductionOptions options;
  options.separation = Separation::equilibrium;
  const Reduction r = Reducer(options).reduce(shot);
  const auto crossings_s = [&](double modulus_Pa) {
    return 4.0 * model.specimen_length_m / std::sqrt(modulus_Pa / model.specimen.density_kg_m3);
  };
  EXPECT_LT(r.assumed_from_s, crossings_s(1.0 / (1.0 / 121e6 + 1.0 / 143e6)));
  EXPECT_GT(r.assumed_from_s, crossings_s(121e6));
  EXPECT_GE(quotable_part(r).from_s, r.assumed_from_s);
  EXPECT_EQ(Reducer().reduce(shot).assumed_from_s, 0.0);
  shot.bench.specimen->density_kg_m3.reset();
  EXPECT_TRUE(std::isinf(Reducer(options).reduce(shot).assumed_from_s));
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

// Pulses that outlast the window: benches solved in the time domain on a staggered grid, with two
// or more gauges on a bar, against the reduction by separated waves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/validity.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::bench_of;
using testing::BenchRecords;
using testing::check_of;
using testing::circle_m2;
using testing::kAluminium;
using testing::kCore;
using testing::kFoam;
using testing::kPmma;
using testing::kPreSamples;
using testing::kStep_s;
using testing::records_of;
using testing::SolvedShot;
using testing::worst;

constexpr double kRange = 0.02;

struct LongShot {
  RodMaterial bars = kPmma;
  RodMaterial specimen = kCore;
  double length_m = 0.7;
  double peak_strain = 1e-3;
  double pulse_s = 700e-6;
  double ramp_s = 60e-6;
  double record_s = 3e-3;
  std::vector<double> input_m = {0.2, 0.45};
  std::vector<double> output_m = {0.05};
  double noise_rms = 0.0;
};

BenchModel model_of(const LongShot& set) {
  BenchModel model;
  model.input = {set.length_m, circle_m2(0.015), set.bars};
  model.specimen = RodShape{0.004, circle_m2(0.012), set.specimen};
  model.output = model.input;
  model.pulse = {.peak_force_N = set.bars.E1_Pa * circle_m2(0.015) * set.peak_strain,
                 .duration_s = set.pulse_s,
                 .ramp_s = set.ramp_s};
  for (const double x : set.input_m) {
    model.gauges.push_back({RodId::input, x});
  }
  for (const double x : set.output_m) {
    model.gauges.push_back({RodId::output, x});
  }
  return model;
}

SolvedShot solve(const LongShot& set) {
  const BenchModel model = model_of(set);
  return testing::shot_of(model, records_of(model, set.record_s), set.noise_rms, kRange);
}

/// The defaults, solved once.
const SolvedShot& plain_shot() {
  static const SolvedShot solved = solve({});
  return solved;
}

Reduction reduced(const Shot& shot, Separation separation, double duration_s = 0.0) {
  ReductionOptions options;
  options.separation = separation;
  if (duration_s > 0.0) {
    options.duration_s = duration_s;
  }
  return Reducer(options).reduce(shot);
}

TEST(SeparatedReduction, APulseThatOutlastsTheWindowIsFollowedToTheEndOfTheFirstLoading) {
  const SolvedShot& solved = plain_shot();
  const Reduction r = Reducer().reduce(solved.shot);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  EXPECT_EQ(r.separation, Separation::gauges);
  // 700 us of push, then the specimen unloads; the first return is at the specimen after 640 us.
  EXPECT_GT(r.time_s.back(), 750e-6);
  EXPECT_LT(worst(r, r.force_front_N, solved, solved.truth.force_front_N), 5e-4);
  EXPECT_LT(worst(r, r.force_back_N, solved, solved.truth.force_back_N), 5e-4);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), 5e-4);
  EXPECT_LT(worst(r, r.strain_rate_per_s, solved, solved.truth.strain_rate_per_s), 2e-3);
  const Check& overlap = check_of(r, "window_overlap");
  EXPECT_EQ(overlap.verdict, Verdict::pass);
  EXPECT_GT(overlap.value, 0.9);
  EXPECT_NE(overlap.text.find("told apart by g1 and g2"), std::string::npos) << overlap.text;
}

// What noise the separation leaves has a slow rise pass its levels microseconds early or late: no
// fault of the bench. A gauge 40 mm off is one, by 18 us.
TEST(SeparatedReduction, NoiseOnASlowRiseIsNoBackForceThatLeads) {
  LongShot slow;
  slow.pulse_s = 900e-6;
  slow.ramp_s = 20e-6;
  slow.length_m = 1.2;
  slow.input_m = {0.6, 0.3};
  slow.output_m = {0.25};
  BenchModel model = model_of(slow);
  model.specimen = RodShape{0.004, circle_m2(0.010), kCore};
  const BenchRecords records = records_of(model, slow.record_s);
  double earliest_s = 0.0;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    const Shot shot = testing::shot_of(model, records, 10e-6, kRange, seed).shot;
    const Check lag = check_of(Reducer().reduce(shot), "front_back_lag");
    EXPECT_EQ(lag.verdict, Verdict::pass) << seed << ": " << lag.text;
    earliest_s = std::min(earliest_s, lag.value);
  }
  EXPECT_LT(earliest_s, -2e-6);  // beyond what timing alone makes of it
  Shot off = testing::shot_of(model, records, 2e-6, kRange, 1).shot;
  off.bench.gauges.back().position_m.value += 0.04;
  EXPECT_EQ(check_of(Reducer().reduce(off), "front_back_lag").verdict, Verdict::warn);
}

TEST(SeparatedReduction, WithoutItTheSameShotIsFarOffAndSaysSo) {
  const SolvedShot& solved = plain_shot();
  const Reduction r = reduced(solved.shot, Separation::never);
  EXPECT_EQ(check_of(r, "window_overlap").verdict, Verdict::fail);
  EXPECT_GT(worst(r, r.strain, solved, solved.truth.strain), 0.3);
  LongShot one;
  one.input_m = {0.45};
  const Shot one_shot = solve(one).shot;
  const Reduction alone = Reducer().reduce(one_shot);
  EXPECT_EQ(alone.separation, Separation::never);
  EXPECT_EQ(check_of(alone, "window_overlap").verdict, Verdict::fail);
  EXPECT_THROW((void)reduced(one_shot, Separation::gauges), InputError);
}

TEST(SeparatedReduction, ElasticBarsWithMoreGaugesThanAreNeeded) {
  LongShot set;
  set.bars = kAluminium;
  set.specimen = kFoam;
  set.length_m = 1.0;
  set.input_m = {0.2, 0.45, 0.6};
  set.output_m = {0.05, 0.3};
  const SolvedShot solved = solve(set);
  const Reduction r = Reducer().reduce(solved.shot);
  EXPECT_EQ(r.separation, Separation::gauges);
  EXPECT_GT(r.time_s.back(), 1.2e-3);  // three returns behind each other
  EXPECT_LT(worst(r, r.force_front_N, solved, solved.truth.force_front_N), 5e-4);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), 5e-4);
}

/// One gauge a bar: the output bar's force at the input bar's end. What that costs is what the
/// specimen is out of equilibrium: a force that is off by d moves the end by d / Z and, twice for
/// each time that the waves have gone to the gauge and back, by 2 d / Z more.
TEST(SeparatedReduction, OneGaugeAndEquilibriumFollowALongPulseToo) {
  LongShot set;
  set.input_m = {0.35};
  const SolvedShot solved = solve(set);
  const Reduction r = reduced(solved.shot, Separation::equilibrium);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  EXPECT_GT(r.time_s.back(), 750e-6);
  EXPECT_LT(worst(r, r.force_back_N, solved, solved.truth.force_back_N), 5e-4);
  const double travel_s = 0.35 / kPmma.front_speed_m_per_s();
  const double times = 1.0 + 2.0 * std::floor(r.time_s.back() / (2.0 * travel_s));
  double impulse = 0.0;
  double largest = 0.0;
  for (std::size_t n = 0; static_cast<double>(n) * kStep_s < r.time_s.back(); ++n) {
    impulse += kStep_s * std::abs(solved.truth.force_front_N[n] - solved.truth.force_back_N[n]);
    largest = std::max(largest, solved.truth.strain[n]);
  }
  const double relaxed_Pa = 1.0 / (1.0 / kPmma.E1_Pa + 1.0 / kPmma.E2_Pa);
  const double least_impedance = std::sqrt(kPmma.density_kg_m3 * relaxed_Pa) * circle_m2(0.015);
  const double bound = times * impulse / least_impedance / 0.004 / largest;
  EXPECT_LT(bound, 0.1);
  EXPECT_LT(worst(r, r.strain, solved, solved.truth.strain), bound);
  EXPECT_EQ(check_of(r, "equilibrium").verdict, Verdict::warn);
  // Both forces are one: what holds one against the other, or their work, tests nothing.
  for (const char* check : {"equilibrium", "front_back_lag", "separation", "energy_balance"}) {
    EXPECT_NE(check_of(r, check).text.find("not tested"), std::string::npos) << check;
  }
}

TEST(SeparatedReduction, APulseThatIsOverInTimeNeedsNoneAndKeepsItsBits) {
  LongShot set;
  set.pulse_s = 170e-6;
  set.ramp_s = 40e-6;
  set.input_m = {0.4, 0.2};
  set.noise_rms = 4e-6;
  const Shot shot = solve(set).shot;
  const Reduction r = Reducer().reduce(shot);
  EXPECT_EQ(r.separation, Separation::never);
  const Reduction plain = reduced(shot, Separation::never);
  EXPECT_EQ(r.stress_Pa, plain.stress_Pa);
  EXPECT_EQ(r.strain, plain.strain);
  // Asked for, it finds the same specimen.
  set.noise_rms = 0.0;
  const SolvedShot solved = solve(set);
  const Reduction asked = reduced(solved.shot, Separation::gauges);
  EXPECT_EQ(asked.separation, Separation::gauges);
  EXPECT_LT(worst(asked, asked.strain, solved, solved.truth.strain), 1e-3);
  EXPECT_LT(worst(asked, asked.force_front_N, solved, solved.truth.force_front_N), 5e-3);
}

/// Elastic bars and a spring that holds on to both, by d'Alembert: a push of 600 us on bars that it
/// crosses in 195, then loading after loading.
TEST(SeparatedReduction, LaterLoadingsAreFollowed) {
  testing::ElasticShpb model;
  model.sampling_frequency_Hz = 4e6;  // every return rounds the pulse's corners once more
  model.pulse_s = 600e-6;
  model.rise_s = 40e-6;
  model.duration_s = 2.6e-3;
  model.second_to_A_m = 0.75;
  const auto records = model.solve();
  const Shot shot = model.shot(records, 0.0, 24, 0.01, 1);
  const Reduction r = reduced(shot, Separation::as_needed, 1.8e-3);
  EXPECT_EQ(r.separation, Separation::gauges);
  EXPECT_GT(r.time_s.back(), 1.79e-3);
  const auto off = [&](const std::vector<double>& history, const std::vector<double>& exact) {
    double largest = 0.0;
    double difference = 0.0;
    for (std::size_t n = 0; n < history.size(); ++n) {
      const double t = std::max(0.0, r.time_s[n] + r.arrival_s - records.truth.arrival_s);
      const double expected = records.truth.at(exact, t);
      largest = std::max(largest, std::abs(expected));
      difference = std::max(difference, std::abs(history[n] - expected));
    }
    return difference / largest;
  };
  EXPECT_LT(off(r.force_front_N, records.truth.force_N), 2e-3);
  EXPECT_LT(off(r.force_back_N, records.truth.force_N), 2e-3);
  EXPECT_LT(off(r.strain, records.truth.strain), 2e-3);

  // What may be quoted is the first loading, up to where the spring begins to let go.
  const auto& strain = records.truth.strain;
  const auto loaded =
      std::find_if(strain.begin(), strain.end(), [](double value) { return value > 1e-4; });
  const auto released = std::find_if(loaded, strain.end(), [](double value) { return value < 0; });
  ASSERT_NE(released, strain.end()) << "loaded once only";
  const double released_s = records.truth.step_s * static_cast<double>(released - strain.begin());
  const double most = *std::max_element(strain.begin(), released);
  const Quotable part = quotable_part(r);
  ASSERT_TRUE(part.any) << part.text;
  EXPECT_LT(part.to_s, released_s);
  EXPECT_NEAR(part.to_strain, most, 0.01 * most);
  EXPECT_LT(summarise(r).loading_s, released_s);
}

TEST(SeparatedReduction, NoiseIsWhatItsCheckSaysAndBlindFrequenciesAreNamed) {
  LongShot set;
  set.record_s = 1.5e-3;
  const BenchModel model = model_of(set);
  const BenchRecords records = records_of(model, set.record_s);
  const Bench bench = bench_of(model);
  ReductionOptions options;
  options.band_limit_Hz = 60e3;
  options.duration_s = 800e-6;
  options.arrival_s =
      kPreSamples * testing::kPeriod_s + set.input_m[0] / kPmma.front_speed_m_per_s();
  Reducer reducer(options);
  const Reduction truth =
      reducer.reduce(testing::digitise(bench, records.strains, 0.0, 24, kRange, 1));
  double peak = 0.0;
  for (const double force : truth.force_front_N) {
    peak = std::max(peak, std::abs(force));
  }
  double squares = 0.0;
  double stated = 0.0;
  constexpr unsigned kShots = 100;
  for (unsigned seed = 1; seed <= kShots; ++seed) {
    const Reduction r =
        reducer.reduce(testing::digitise(bench, records.strains, 4e-6, 16, kRange, seed));
    ASSERT_EQ(r.time_s.size(), truth.time_s.size());
    squares += std::pow((r.force_front_N.back() - truth.force_front_N.back()) / peak, 2);
    stated += check_of(r, "separated_noise").value / kShots;
  }
  EXPECT_NEAR(std::sqrt(squares / kShots), stated, 0.25 * stated);  // 7 % is one sigma of this
  // Half a wave between the gauges: c / (2 x 0.25 m), the wave at some 2170 m/s.
  const std::string text = check_of(truth, "separated_noise").text;
  EXPECT_NE(text.find("blind at 0.0"), std::string::npos) << text;
  EXPECT_NE(text.find(", 4.2"), std::string::npos) << text;
}

// Bars of 15 mm under a pulse of 60 us rise: lateral inertia hardly shows in them, and the band
// that the noise allows has its flank where Love's waves stand still.
TEST(SeparatedReduction, LovesWavesGiveWhatElementaryOnesDoOfThinBars) {
  for (const Separation how : {Separation::gauges, Separation::equilibrium}) {
    ReductionOptions options;
    options.separation = how;
    const Reduction elementary = Reducer(options).reduce(plain_shot().shot);
    options.theory = WaveTheory::love;
    const Reduction love = Reducer(options).reduce(plain_shot().shot);
    ASSERT_TRUE(love.quality.reducible) << love.quality.reason;
    const double peak_Pa = summarise(elementary).peak_stress_Pa;
    EXPECT_NEAR(summarise(love).peak_stress_Pa, peak_Pa, 0.05 * peak_Pa) << name_of(how);
  }
}

TEST(SeparatedReduction, WhatIsNoNumberIsNoResult) {
  Shot shot = plain_shot().shot;
  shot.bench.gauges.back().position_m = shot.bench.output->length_m;  // free: no strain there
  const Quality quality = Reducer().reduce(shot).quality;
  EXPECT_FALSE(quality.reducible);
  EXPECT_NE(quality.reason.find("no finite numbers"), std::string::npos) << quality.reason;
  EXPECT_NE(quality.mend.find("positions"), std::string::npos) << quality.mend;
}

TEST(SeparatedReduction, ARecordThatEndsInTheLoadingIsNamed) {
  LongShot set;
  set.record_s = 0.8e-3;
  const Reduction r = Reducer().reduce(solve(set).shot);
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  EXPECT_EQ(check_of(r, "window_overlap").verdict, Verdict::warn);
  EXPECT_NE(check_of(r, "window_overlap").text.find("record ends before"), std::string::npos);
}

}  // namespace
}  // namespace kolsky

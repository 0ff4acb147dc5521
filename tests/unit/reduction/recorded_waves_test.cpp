// Waves of a bar told from its gauges, against a bench solved in the time domain on a staggered
// grid: what another gauge saw, and what the specimen's faces did.
#include "processing/reduction/recorded_waves.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "tests/generators/bar_shots.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::circle_m2;
using testing::kCore;
using testing::kPmma;
using testing::SolvedShot;

constexpr double kArea_m2 = 1.767145867644259e-4;  // 15 mm across
constexpr double kLength_m = 0.7;

/// PMMA bars of 0.7 m under 700 us of push: no wave is ever alone at a gauge.
BenchModel overlapping() {
  BenchModel model;
  model.input = {kLength_m, kArea_m2, kPmma};
  model.specimen = RodShape{0.004, circle_m2(0.012), kCore};
  model.output = model.input;
  model.pulse = {
      .peak_force_N = kPmma.E1_Pa * kArea_m2 * 1e-3, .duration_s = 700e-6, .ramp_s = 60e-6};
  model.gauges = {
      {RodId::input, 0.2}, {RodId::input, 0.45}, {RodId::input, 0.6}, {RodId::output, 0.05}};
  return model;
}

SolvedShot solved(double noise_rms) {
  static const testing::BenchRecords records = testing::records_of(overlapping(), 3e-3);
  return testing::shot_of(overlapping(), records, noise_rms, 0.02);
}

Shot without_gauge(Shot shot, std::size_t gauge) {
  shot.bench.gauges.erase(shot.bench.gauges.begin() + static_cast<std::ptrdiff_t>(gauge));
  shot.channels.erase(shot.channels.begin() + static_cast<std::ptrdiff_t>(gauge));
  return shot;
}

/// Largest difference over the truth's largest value, as far as the waves are known.
double off(const RecordedWaves& waves, const std::vector<double>& found,
           const std::vector<double>& truth) {
  double difference = 0.0;
  double largest = 0.0;
  for (std::size_t n = 0; n < std::min(waves.known, truth.size()); ++n) {
    difference = std::max(difference, std::abs(found[n] - truth[n]));
    largest = std::max(largest, std::abs(truth[n]));
  }
  return difference / largest;
}

std::vector<double> strain_of(const SeparatedWaves& waves) {
  std::vector<double> sum(waves.right_going);
  std::transform(sum.begin(), sum.end(), waves.left_going.begin(), sum.begin(), std::plus<>());
  return sum;
}

std::vector<double> record_of(const Shot& shot, std::size_t channel) {
  const auto& strain_per_V = shot.bench.gauges[channel].strain_per_V;
  const double unit = strain_per_V ? strain_per_V->value : 1.0;
  std::vector<double> strain;
  for (const std::int32_t code : shot.channels[channel].codes) {
    strain.push_back(unit * shot.channels[channel].value(code));
  }
  return strain;
}

TEST(RecordedWaves, TwoGaugesForetellTheThirdWhereWavesAlwaysOverlap) {
  const SolvedShot shot = solved(0.0);
  const RecordedWaves waves = recorded_waves(without_gauge(shot.shot, 1), {.positions_m = {0.45}});
  EXPECT_EQ(waves.gauges, (std::vector<std::string>{"g1", "g3"}));
  EXPECT_FALSE(waves.end_known) << "the input bar's end is at the specimen";
  EXPECT_TRUE(waves.left.empty()) << "two gauges leave nothing of each other's records";
  EXPECT_LT(off(waves, strain_of(waves.places.front().waves), record_of(shot.shot, 1)), 2e-3);
}

TEST(RecordedWaves, GiveTheForcesOnBothFacesOfTheSpecimen) {
  const SolvedShot shot = solved(0.0);
  const RecordedWaves in = recorded_waves(shot.shot, {.positions_m = {kLength_m}});
  const RecordedWaves out = recorded_waves(shot.shot, {.bar = "output", .positions_m = {0.0}});
  EXPECT_EQ(out.gauges, std::vector<std::string>{"g4"});
  EXPECT_TRUE(out.end_known);
  const auto force = [](const RecordedWaves& waves) {
    std::vector<double> newtons(waves.places.front().waves.stress_Pa);
    std::ranges::for_each(newtons, [](double& value) { value *= kArea_m2; });
    return newtons;
  };
  const auto on_records_clock = [&](const std::vector<double>& truth) {
    std::vector<double> record;
    for (std::size_t n = 0; n < in.places.front().waves.stress_Pa.size(); ++n) {
      const double t = static_cast<double>(n) * testing::kPeriod_s - shot.front_arrival_s;
      const double step = (t - shot.truth.time_s.front()) / testing::kStep_s;
      const auto i = static_cast<std::size_t>(std::max(0.0, std::round(step)));
      record.push_back(step < 0.0 ? 0.0 : truth[std::min(i, truth.size() - 1)]);
    }
    return record;
  };
  EXPECT_LT(off(in, force(in), on_records_clock(shot.truth.force_front_N)), 2e-3);
  EXPECT_LT(off(out, force(out), on_records_clock(shot.truth.force_back_N)), 2e-3);
}

// A gauge that is not where it is filed shows in what the waves leave of the records.
TEST(RecordedWaves, WhatTheyLeaveIsNoiseUnlessSomethingIsNotAsFiled) {
  Shot shot = solved(4e-6).shot;
  for (const GaugeLeft& gauge : recorded_waves(shot, {}).left) {
    // Three gauges share two waves: each keeps some of its noise.
    EXPECT_LT(gauge.left_rms, 1.3 * gauge.noise_rms) << gauge.gauge;
    EXPECT_GT(gauge.left_rms, 0.1 * gauge.noise_rms) << gauge.gauge;
  }
  shot.bench.gauges[1].position_m.value += 0.005;
  double most = 0.0;
  for (const GaugeLeft& gauge : recorded_waves(shot, {}).left) {
    most = std::max(most, gauge.left_rms / gauge.noise_rms);
  }
  EXPECT_GT(most, 3.0);
}

// Between 0.2 and 0.6 m half a wave fits at 2.2 km/s / 0.8 m.
// A filter of few hertz spreads waves over more than the room before and after a record: what came
// round was made larger by 10^8.
TEST(RecordedWaves, ANarrowBandSpreadsThemAndMakesThemSmaller) {
  const Shot shot = without_gauge(solved(2e-6).shot, 2);
  RecordedWavesOptions options;
  options.positions_m = {kLength_m};
  const auto most = [&](const RecordedWaves& waves) {
    double largest = 0.0;
    for (std::size_t n = 0; n < waves.known; ++n) {
      largest = std::max(largest, std::abs(waves.places.front().waves.stress_Pa[n]));
    }
    return largest;
  };
  const double whole_Pa = most(recorded_waves(shot, options));
  for (const double band_limit_Hz : {600.0, 1000.0, 2000.0}) {
    options.band_limit_Hz = band_limit_Hz;
    EXPECT_LT(most(recorded_waves(shot, options)), 1.05 * whole_Pa) << band_limit_Hz;
  }
}

TEST(RecordedWaves, NameTheFrequenciesToWhichTheGaugesAreBlind) {
  const RecordedWaves waves = recorded_waves(without_gauge(solved(4e-6).shot, 1), {});
  ASSERT_GE(waves.blind.size(), 2U);
  EXPECT_LT(waves.blind[0].frequency_Hz, 100.0);
  EXPECT_NEAR(waves.blind[1].frequency_Hz, 2160.0 / 0.8, 100.0);
}

// The deviation that is stated of the stress is what another shot's noise does to it.
TEST(RecordedWaves, StateTheirNoise) {
  const RecordedWavesOptions face{.positions_m = {kLength_m}, .band_limit_Hz = 20e3};
  const SolvedShot quiet = solved(0.0);
  const auto truth = recorded_waves(without_gauge(quiet.shot, 1), face);
  static const testing::BenchRecords records = testing::records_of(overlapping(), 3e-3);
  constexpr unsigned kRepeats = 40;
  double squares = 0.0;
  double stated_Pa = 0.0;
  const std::size_t at = truth.known - 200;
  for (unsigned seed = 1; seed <= kRepeats; ++seed) {
    const Shot noisy = testing::shot_of(overlapping(), records, 4e-6, 0.02, seed).shot;
    const RecordedWaves waves = recorded_waves(without_gauge(noisy, 1), face);
    squares += std::pow(
        waves.places.front().waves.stress_Pa[at] - truth.places.front().waves.stress_Pa[at], 2);
    stated_Pa += waves.places.front().stress_noise_Pa[at] / kRepeats;
  }
  EXPECT_NEAR(std::sqrt(squares / kRepeats) / stated_Pa, 1.0, 0.35);  // three deviations of 40
}

TEST(RecordedWaves, OneGaugeOnABarThatEndsFreeForetellsTheOthers) {
  testing::BarShots::Setup setup;
  setup.material = kPmma;
  setup.length_m = 1.0;
  setup.position_m = {0.2, 0.5, 0.65};
  std::mt19937_64 random(1);
  const Shot shot = testing::BarShots(setup).draw(1, {.noise_rms = 0.0}, random).front();
  const Shot alone = without_gauge(without_gauge(shot, 2), 0);
  const RecordedWaves waves = recorded_waves(alone, {.positions_m = {0.2, 0.65}});
  EXPECT_TRUE(waves.end_known);
  EXPECT_LT(off(waves, strain_of(waves.places[0].waves), record_of(shot, 0)), 2e-3);
  EXPECT_LT(off(waves, strain_of(waves.places[1].waves), record_of(shot, 2)), 2e-3);
  try {
    (void)recorded_waves(alone, {.gauges_only = true});
    FAIL() << "one gauge does not part waves";
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "gauges");
  }
}

// Of a stiff short specimen both faces carry the same force but for its start.
TEST(RecordedWaves, OneGaugeAndTheOtherBarsForceServeLikeTwoGauges) {
  const SolvedShot shot = solved(0.0);
  const Shot one = without_gauge(without_gauge(shot.shot, 2), 0);
  const RecordedWaves waves = recorded_waves(one, {.positions_m = {0.2}, .equilibrium = true});
  EXPECT_EQ(waves.gauges, std::vector<std::string>{"g2"});
  // A force that is off by d sends a wave of d to the gauge, and once more what that leaves there.
  double apart_N = 0.0;
  for (std::size_t n = 0; n < shot.truth.force_front_N.size(); ++n) {
    apart_N = std::max(apart_N, std::abs(shot.truth.force_front_N[n] - shot.truth.force_back_N[n]));
  }
  const std::vector<double> truth = record_of(shot.shot, 0);
  const double largest_N = kPmma.E1_Pa * kArea_m2 * std::ranges::max(truth);
  const double error = off(waves, strain_of(waves.places.front().waves), truth);
  EXPECT_LT(error, 2.0 * apart_N / largest_N);
  EXPECT_LT(error, 0.05);
}

/// The place of the error, or nothing.
std::string refusal(const Shot& shot, const RecordedWavesOptions& options) {
  try {
    (void)recorded_waves(shot, options);
  } catch (const InputError& error) {
    return error.place();
  }
  return "nothing";
}

TEST(RecordedWaves, WhatCannotBeToldIsRefused) {
  const Shot shot = solved(4e-6).shot;
  const auto place = refusal;
  EXPECT_EQ(place(shot, {.bar = "third"}), "bar");
  EXPECT_EQ(place(shot, {.positions_m = {0.71}}), "position");
  EXPECT_EQ(place(shot, {.band_limit_Hz = 0.6e6}), "band_limit_Hz");
  EXPECT_EQ(place(shot, {.theory = WaveTheory::exact, .band_limit_Hz = 200e3}), "band_limit_Hz");
  EXPECT_EQ(place(without_gauge(without_gauge(shot, 0), 0), {}), "gauges");
  EXPECT_EQ(place(without_gauge(shot, 3), {.bar = "output"}), "record");
  EXPECT_EQ(place(shot, {.bar = "output", .equilibrium = true}), "equilibrium");
  Shot silent = shot;
  for (ChannelRecord& channel : silent.channels) {
    channel.codes.resize(300);  // the impact comes after 400
  }
  EXPECT_EQ(place(silent, {}), "record");
}

TEST(RecordedWaves, ThatAreNoNumbersAreRefused) {
  Shot shot = solved(4e-6).shot;
  shot.bench.gauges.back().position_m = shot.bench.output->length_m;  // free: no strain there
  EXPECT_EQ(refusal(shot, {.bar = "output"}), "record");
}

TEST(RecordedWaves, OfRecordsThatAreNotWholeAreRefused) {
  const Shot shot = solved(4e-6).shot;
  Shot holed = shot;
  holed.gaps.push_back({.first_tick = shot.first_tick + 900, .samples = 3});
  EXPECT_EQ(refusal(holed, {}), "record");
  Shot clipped = shot;
  clipped.channels[1].codes[900] = clipped.channels[1].code_max;
  EXPECT_EQ(refusal(clipped, {}), "record");
}

// Moduli are known as far as the bars were identified: no default goes further, and no one may ask.
TEST(RecordedWaves, StayWithinTheBandOfTheBarModel) {
  const Shot shot = solved(4e-6).shot;
  const double free_Hz = recorded_waves(shot, {}).band_limit_Hz;
  Material model = assumed_bars(shot.bench);
  model.identified.emplace().band_limit_Hz = 0.5 * free_Hz;
  EXPECT_DOUBLE_EQ(recorded_waves(shot, {.bar_model = model}).band_limit_Hz, 0.5 * free_Hz);
  EXPECT_EQ(refusal(shot, {.band_limit_Hz = 0.6 * free_Hz, .bar_model = model}),
            "the bar model given");
  Shot filed = shot;
  filed.bar_model = model;
  EXPECT_DOUBLE_EQ(recorded_waves(filed, {}).band_limit_Hz, 0.5 * free_Hz);
}

}  // namespace
}  // namespace kolsky

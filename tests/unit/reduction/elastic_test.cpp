// Against a time-domain solution of elastic bars with a massless linear spring between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/validity.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::check_of;
using testing::ElasticShpb;

/// Largest difference between a reduced history and the truth, as a share of the truth's largest
/// value, on the record's own clock (how well the arrival was found is another question).
double worst(const Reduction& r, const std::vector<double>& reduced,
             const ElasticShpb::Truth& truth, const std::vector<double>& exact) {
  double largest = 0.0;
  double difference = 0.0;
  for (std::size_t n = 0; n < reduced.size(); ++n) {
    const double t = r.time_s[n] + r.arrival_s - truth.arrival_s;
    const double expected = t < 0.0 ? 0.0 : truth.at(exact, t);
    largest = std::max(largest, std::abs(expected));
    difference = std::max(difference, std::abs(reduced[n] - expected));
  }
  return difference / largest;
}

Shot noiseless(const ElasticShpb& model, const ElasticShpb::Records& records) {
  return model.shot(records, 0.0, 24, 0.01, 1);
}

void expect_truth(const Reduction& r, const ElasticShpb::Truth& truth, double share) {
  ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
  EXPECT_LT(worst(r, r.force_front_N, truth, truth.force_N), share);
  EXPECT_LT(worst(r, r.force_back_N, truth, truth.force_N), share);
  EXPECT_LT(worst(r, r.strain, truth, truth.strain), share);
  // The rate has a corner where the pulse's edge ends; sampling at 1 MHz rounds it.
  EXPECT_LT(worst(r, r.strain_rate_per_s, truth, truth.strain_rate_per_s), 3 * share);
}

TEST(ElasticReduction, FirstLoadingIsTheTimeDomainSolution) {
  const ElasticShpb model;
  const auto records = model.solve();
  const Reduction r = Reducer().reduce(noiseless(model, records));
  expect_truth(r, records.truth, 5e-4);
  EXPECT_NEAR(r.time_s.back(), 2.0 * 1.0 / std::sqrt(206e9 / 7850.0), 2e-6);
}

// What lateral inertia slows is carried back by more than a front is: none of it may come round to
// the record's end, where it would be all there is to see.
TEST(ElasticReduction, SlowWavesOfAWideBandDoNotComeRound) {
  ElasticShpb model;
  model.length_in_m = model.length_out_m = 2.0;
  model.gauge_to_A_m = 1.02;
  model.gauge_to_B_m = 0.77;
  model.duration_s = 1.2e-3;
  model.sampling_frequency_Hz = 4e6;
  const Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 1);
  const auto peak = [&](WaveTheory theory) {
    ReductionOptions options;
    options.theory = theory;
    options.band_limit_Hz = 110e3;  // a f / c0 = 0.21
    const Reduction r = Reducer(options).reduce(shot);
    EXPECT_TRUE(r.quality.reducible) << r.quality.reason;
    return *std::max_element(r.stress_Pa.begin(), r.stress_Pa.end());
  };
  const double plain = peak(WaveTheory::elementary);
  // These waves are elementary ones: exact theory makes them ring, by half of the peak.
  EXPECT_NEAR(peak(WaveTheory::love), plain, 0.3 * plain);
  EXPECT_NEAR(peak(WaveTheory::exact), plain, 0.8 * plain);
}

// What lateral inertia slows has not come to the gauges when a front has: histories that ran on to
// a front's travel before the record's end held what was missing as a wave of half their size.
TEST(ElasticReduction, HistoriesOfSlowWavesEndBeforeARecordLacksThem) {
  ElasticShpb model;
  model.length_in_m = model.length_out_m = 1.5;
  model.gauge_to_A_m = model.gauge_to_B_m = 0.75;
  model.pulse_s = 200e-6;
  const Shot shot = noiseless(model, model.solve());
  for (const WaveTheory theory : {WaveTheory::love, WaveTheory::exact}) {
    ReductionOptions options;
    options.theory = theory;
    options.band_limit_Hz = 70e3;
    const Reduction whole = Reducer(options).reduce(shot);
    for (const std::size_t samples : {950U, 1000U, 1100U}) {
      Shot cut = shot;
      for (ChannelRecord& channel : cut.channels) {
        channel.codes.resize(samples);
      }
      const Reduction r = Reducer(options).reduce(cut);
      ASSERT_TRUE(r.quality.reducible) << r.quality.reason;
      ASSERT_LT(r.stress_Pa.size(), whole.stress_Pa.size());
      const double peak_Pa = *std::ranges::max_element(whole.stress_Pa);
      for (std::size_t n = 0; n < r.stress_Pa.size(); ++n) {
        ASSERT_NEAR(r.stress_Pa[n], whole.stress_Pa[n], 0.01 * peak_Pa)
            << name_of(theory) << ", " << samples << " samples, at " << n;
      }
    }
  }
}

bool says_lateral_inertia(const Shot& shot) {
  const Reduction r = Reducer().reduce(shot);
  EXPECT_TRUE(r.quality.reducible) << r.quality.reason;
  return std::ranges::any_of(r.quality.checks,
                             [](const Check& check) { return check.name == "wave_theory"; });
}

// It was told of the damped records: there the noise before a pulse weighs more than the pulse, the
// more the shorter they are.
TEST(ElasticReduction, LateralInertiaIsToldOfThePulseAndNotOfItsNoise) {
  ElasticShpb model;
  model.length_in_m = 1.5;
  model.gauge_to_A_m = 1.0;
  model.foot_at_gauge_s = 400e-6;
  for (const double duration_s : {1.0e-3, 1.3e-3, 4e-3}) {
    model.duration_s = duration_s;
    model.rise_s = 50e-6;
    EXPECT_FALSE(says_lateral_inertia(model.shot(model.solve(), 3e-6, 16, 0.01, 1))) << duration_s;
    model.rise_s = 3e-6;
    EXPECT_TRUE(says_lateral_inertia(model.shot(model.solve(), 3e-6, 16, 0.01, 1))) << duration_s;
  }
}

/// Of half a sine, the rate of an edge, rms over rms: what its mean over a time is off by.
double lost_in_mean(double edge_s, double time_s) {
  const double pi = std::numbers::pi;
  const auto risen = [&](double t) {
    const double place = std::clamp(t / edge_s, 0.0, 1.0);
    return edge_s / pi * (1.0 - std::cos(pi * place));
  };
  double lost = 0.0;
  double all = 0.0;
  for (double t = -time_s; t < edge_s + time_s; t += 1e-8) {
    const double rate = t > 0.0 && t < edge_s ? std::sin(pi * t / edge_s) : 0.0;
    const double mean = (risen(t + time_s / 2.0) - risen(t - time_s / 2.0)) / time_s;
    lost += std::pow(rate - mean, 2);
    all += rate * rate;
  }
  return std::sqrt(lost / all);
}

TEST(ElasticReduction, SaysWhatALongGaugeLosesOfAFront) {
  ElasticShpb model;
  model.rise_s = 20e-6;
  Shot shot = noiseless(model, model.solve());
  const auto said = [&](double length_m) {
    shot.bench.gauges[1].length_m = Measured{length_m, 0.0};
    const Reduction r = Reducer().reduce(shot);
    const auto check = std::ranges::find(r.quality.checks, "gauge_length", &Check::name);
    return check != r.quality.checks.end() ? check->value : 0.0;
  };
  EXPECT_EQ(said(0.0), 0.0);
  EXPECT_EQ(said(0.003), 0.0);
  const double speed_m_per_s = std::sqrt(model.youngs_modulus_Pa / model.density_kg_m3);
  const double exact = lost_in_mean(model.rise_s, 0.03 / speed_m_per_s);
  EXPECT_NEAR(said(0.03), exact, 0.1 * exact);
}

TEST(ElasticReduction, BandOfExactWavesEndsBeforeSurfaceGaugesGoBlind) {
  ElasticShpb model;
  model.sampling_frequency_Hz = 4e6;
  const Shot shot = noiseless(model, model.solve());
  const Bar& bar = shot.bench.input;
  // a f / c0 from which gauges read less than half of the mean strain (reference table, M1 = 2).
  const double c0_m_per_s = std::sqrt(bar.youngs_modulus_Pa->value / bar.density_kg_m3.value);
  const double blind_Hz = 0.26 * c0_m_per_s / bar.dispersion_radius_m();
  ReductionOptions options;
  options.theory = WaveTheory::exact;
  const double limit_Hz = Reducer(options).reduce(shot).band_limit_Hz;
  // exp(-ln 2 (f / limit)^4) = 0.01 where they go blind.
  EXPECT_NEAR(limit_Hz, blind_Hz / std::pow(std::log(100.0) / std::log(2.0), 0.25),
              0.05 * limit_Hz);
  options.band_limit_Hz = 1.1 * blind_Hz;
  const auto problem = [&]() -> std::string {
    try {
      static_cast<void>(Reducer(options).reduce(shot));
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  EXPECT_NE(problem().find("half of the mean strain"), std::string::npos) << problem();
  options.theory = WaveTheory::elementary;
  EXPECT_EQ(problem(), "");
}

TEST(ElasticReduction, StressIsForceOverTheSpecimen) {
  const ElasticShpb model;
  const Reduction r = Reducer().reduce(noiseless(model, model.solve()));
  const double area_m2 = 0.25 * 3.14159265358979 * 0.008 * 0.008;
  const std::size_t n = r.time_s.size() / 4;
  EXPECT_NEAR(r.stress_Pa[n], (r.force_front_N[n] + r.force_back_N[n]) / 2 / area_m2,
              1e-9 * std::abs(r.stress_Pa[n]));
  // A spring: stress over strain is its modulus, whatever the bars did.
  EXPECT_NEAR(r.stress_Pa[n] / r.strain[n], 2e9, 2e6);
}

TEST(ElasticReduction, LaterLoadingsAreFollowedThroughTheReturnsFromTheFarEnds) {
  ElasticShpb model;
  model.sampling_frequency_Hz = 4e6;  // every return rounds the pulse's corners once more
  const auto records = model.solve();
  ReductionOptions options;
  options.duration_s = 1e-3;  // the second and third return at 390 and 780 us
  const Reduction r = Reducer(options).reduce(noiseless(model, records));
  expect_truth(r, records.truth, 1e-3);
  EXPECT_GT(r.time_s.back(), 0.99e-3);
}

TEST(ElasticReduction, WhatIsQuotedIsOfTheFirstLoading) {
  const ElasticShpb model;
  const auto records = model.solve();
  const Shot shot = noiseless(model, records);
  const LoopSummary first = summarise(Reducer().reduce(shot));
  ReductionOptions longer;
  longer.duration_s = 1e-3;
  Reduction followed = Reducer(longer).reduce(shot);
  const LoopSummary all = summarise(followed);
  EXPECT_NEAR(all.peak_strain, first.peak_strain, 1e-3 * first.peak_strain);
  EXPECT_NEAR(all.peak_stress_Pa, first.peak_stress_Pa, 1e-3 * first.peak_stress_Pa);
  // A later one that goes further changes nothing.
  for (std::size_t n = followed.strain.size() / 2; n < followed.strain.size(); ++n) {
    followed.strain[n] *= 2.0;
    followed.stress_Pa[n] *= 2.0;
  }
  EXPECT_EQ(summarise(followed).peak_strain, all.peak_strain);
  EXPECT_EQ(summarise(followed).peak_stress_Pa, all.peak_stress_Pa);
}

const Check& loop_closure(const Reduction& r) {
  const Check* check = r.quality.find("loop_closure");
  EXPECT_NE(check, nullptr);
  return *check;
}

TEST(ElasticReduction, ALoopClosesBeforeItIsLoadedAgain) {
  ElasticShpb model;
  model.specimen_modulus_Pa = 20e9;  // free of strain 150 us after the pulse
  const auto records = model.solve();
  ReductionOptions options;
  options.duration_s = 450e-6;  // the second loading begins at 390 us
  const Reduction r = Reducer(options).reduce(noiseless(model, records));
  EXPECT_GT(std::abs(r.strain.back()), 0.3 * summarise(r).peak_strain);
  const Check& closure = loop_closure(r);
  EXPECT_EQ(closure.verdict, Verdict::pass) << closure.text;
  EXPECT_LT(closure.value, 0.02);
  EXPECT_NE(closure.text.find("before it is loaded again"), std::string::npos) << closure.text;
}

TEST(ElasticReduction, ALoopThatHasNotComeBackIsOpen) {
  const ElasticShpb model;  // unloads within a quarter of a millisecond
  const auto records = model.solve();
  ReductionOptions options;
  options.duration_s = 250e-6;
  const Reduction r = Reducer(options).reduce(noiseless(model, records));
  const auto& strain = records.truth.strain;
  const double left =
      std::abs(records.truth.at(strain, r.time_s.back())) /
      *std::max_element(strain.begin(), strain.begin() + static_cast<std::ptrdiff_t>(
                                                             250e-6 / records.truth.step_s));
  const Check& closure = loop_closure(r);
  EXPECT_EQ(closure.verdict, Verdict::warn) << closure.text;
  EXPECT_NEAR(closure.value, left, 0.01);
  EXPECT_EQ(closure.text.find("loaded again"), std::string::npos) << closure.text;
}

TEST(ElasticReduction, BarsOfDifferentLengthAndAnyGaugePosition) {
  ElasticShpb model;
  model.length_in_m = 1.3;
  model.length_out_m = 0.8;
  model.gauge_to_A_m = 0.613;
  model.gauge_to_B_m = 0.1217;
  const auto records = model.solve();
  expect_truth(Reducer().reduce(noiseless(model, records)), records.truth, 5e-4);
}

TEST(ElasticReduction, TensionIsCompressionWithTheSignTurned) {
  ElasticShpb model;
  const auto compressed = Reducer().reduce(noiseless(model, model.solve()));
  model.pulse_strain = -model.pulse_strain;
  const auto records = model.solve();
  Shot pulling = noiseless(model, records);
  pulling.bench.loading = PositiveSense::tension;
  const auto stretched = Reducer().reduce(pulling);
  expect_truth(stretched, records.truth, 5e-4);
  EXPECT_LT(*std::min_element(stretched.strain.begin(), stretched.strain.end()), -0.01);
  EXPECT_NEAR(stretched.arrival_s, compressed.arrival_s, 1e-9);
  // What is said of both is the same but for the sign.
  const LoopSummary shortened = summarise(compressed);
  const LoopSummary lengthened = summarise(stretched);
  EXPECT_EQ(lengthened.no_loading, "");
  EXPECT_NEAR(lengthened.peak_stress_Pa, -shortened.peak_stress_Pa,
              1e-3 * shortened.peak_stress_Pa);
  EXPECT_NEAR(lengthened.peak_strain, -shortened.peak_strain, 1e-3 * shortened.peak_strain);
  EXPECT_NEAR(lengthened.loading_s, shortened.loading_s, 1e-6);
  ASSERT_EQ(stretched.quality.checks.size(), compressed.quality.checks.size());
  for (const Check& check : compressed.quality.checks) {
    const Check& turned = check_of(stretched, check.name);
    EXPECT_EQ(turned.verdict, check.verdict) << check.name << ": " << turned.text;
    EXPECT_NEAR(turned.value, check.value, 2e-3 * std::max(1.0, std::abs(check.value)))
        << check.name << ": " << turned.text;
  }
  EXPECT_TRUE(quotable_part(compressed).any);
  EXPECT_TRUE(quotable_part(stretched).any);
  ReductionOptions rubbing;
  rubbing.corrections.friction = 0.1;
  const Quality refused = Reducer(rubbing).reduce(noiseless(model, records)).quality;
  EXPECT_FALSE(refused.reducible);
  EXPECT_NE(refused.reason.find("friction"), std::string::npos) << refused.reason;
}

TEST(ElasticReduction, ABenchThatCountsTensionPositiveGivesTheSameCompression) {
  const ElasticShpb model;
  Shot shot = noiseless(model, model.solve());
  const Reduction plain = Reducer().reduce(shot);
  shot.bench.positive = PositiveSense::tension;
  for (ChannelRecord& channel : shot.channels) {
    for (std::int32_t& code : channel.codes) {
      code = -code;
    }
  }
  const Reduction turned = Reducer().reduce(shot);
  ASSERT_EQ(turned.stress_Pa.size(), plain.stress_Pa.size());
  EXPECT_EQ(turned.stress_Pa, plain.stress_Pa);
}

// The arrival that is printed is at the specimen; the one that is given is at the gauge.
TEST(ElasticReduction, AnArrivalThatIsNotThePulsesFootIsNamed) {
  const ElasticShpb model;
  const Shot shot = noiseless(model, model.solve());
  EXPECT_EQ(Reducer().reduce(shot).quality.find("arrival"), nullptr);
  const auto given = [&](double late_s) {
    ReductionOptions options;
    options.arrival_s = model.foot_at_gauge_s + late_s;
    return Reducer(options).reduce(shot);
  };
  EXPECT_EQ(check_of(given(0.0), "arrival").verdict, Verdict::pass);
  EXPECT_EQ(check_of(given(-50e-6), "arrival").verdict, Verdict::warn);
  const Check late = check_of(given(15e-6), "arrival");
  EXPECT_EQ(late.verdict, Verdict::warn);
  EXPECT_NEAR(late.value, 15e-6, 2e-6);
  // From the gauge at c = sqrt(E / rho).
  EXPECT_NE(late.text.find("at the specimen, 97.6 us after"), std::string::npos) << late.text;
  const Quality later = given(49e-6).quality;
  EXPECT_NE(later.reason.find("later than the foot of the first pulse"), std::string::npos)
      << later.reason;
  const Quality earlier = given(-150e-6).quality;
  EXPECT_NE(earlier.reason.find("earlier than the foot of the first pulse"), std::string::npos)
      << earlier.reason;
}

TEST(ElasticReduction, NoiseCostsWhatItMust) {
  const ElasticShpb model;
  const auto records = model.solve();
  double squares = 0.0;
  std::size_t count = 0;
  Reducer reducer;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Reduction r = reducer.reduce(model.shot(records, 4e-6, 16, 0.01, seed));
    ASSERT_TRUE(r.quality.reducible);
    for (std::size_t n = 0; n < r.time_s.size(); ++n) {
      const double t = std::max(0.0, r.time_s[n] + r.arrival_s - records.truth.arrival_s);
      const double error = r.force_back_N[n] - records.truth.at(records.truth.force_N, t);
      squares += error * error;
      ++count;
    }
  }
  // One gauge's noise as force is E A 4e-6. Within the window the wave that comes back from the far
  // end adds another, independent one for part of the time: sqrt(2) at most. The filter takes some
  // away.
  const double one_gauge_N = 206e9 * 0.25 * 3.14159265358979 * 0.020 * 0.020 * 4e-6;
  const double rms_N = std::sqrt(squares / static_cast<double>(count));
  EXPECT_LT(rms_N, std::sqrt(2.0) * one_gauge_N);
  EXPECT_GT(rms_N, 0.3 * one_gauge_N);
}

TEST(ElasticReduction, ArrivalIsNearerThanItsSigmaSays) {
  const ElasticShpb model;
  const auto records = model.solve();
  // A raised-cosine edge of 20 us: the foot is found within 5 % of the edge.
  const double noiseless_s = Reducer().reduce(noiseless(model, records)).arrival_s;
  EXPECT_NEAR(noiseless_s, records.truth.arrival_s, 1e-6);
  double squares = 0.0;
  double stated = 0.0;
  constexpr int kShots = 60;
  Reducer reducer;
  for (unsigned seed = 1; seed <= kShots; ++seed) {
    const Reduction r = reducer.reduce(model.shot(records, 4e-6, 16, 0.01, seed));
    squares += std::pow(r.arrival_s - records.truth.arrival_s, 2);
    stated += r.arrival_sigma_s;
  }
  const double off_s = std::sqrt(squares / kShots);
  EXPECT_LT(off_s, 2.0 * stated / kShots);
  EXPECT_GT(off_s, stated / kShots / 3.0);
}

// A filter with less band than the edge rounds it off, so that it seems to begin before it does.
TEST(ElasticReduction, ABandBelowThePulseLeavesItsArrivalAsFarOffAsItSays) {
  const ElasticShpb model;
  const auto records = model.solve();
  for (const double limit_Hz : {5e3, 15e3, 30e3}) {
    ReductionOptions options;
    options.band_limit_Hz = limit_Hz;
    Reducer reducer(options);
    double squares = 0.0;
    double stated = 0.0;
    constexpr int kShots = 30;
    for (unsigned seed = 1; seed <= kShots; ++seed) {
      const Reduction r = reducer.reduce(model.shot(records, 4e-6, 16, 0.01, seed));
      squares += std::pow(r.arrival_s - records.truth.arrival_s, 2);
      stated += r.arrival_sigma_s / kShots;
    }
    const double off_s = std::sqrt(squares / kShots);
    EXPECT_LT(off_s, 2.0 * stated) << limit_Hz;
    EXPECT_LT(stated, 5e-6) << limit_Hz;
    EXPECT_LT(off_s, 2e-6) << limit_Hz;
  }
}

TEST(ElasticReduction, ABandThatHoldsNoPulseIsRefused) {
  const ElasticShpb model;
  const Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 1);
  ReductionOptions options;
  for (const double limit_Hz : {1.0, 100.0, 1e3}) {
    options.band_limit_Hz = limit_Hz;
    EXPECT_THROW((void)Reducer(options).reduce(shot), InputError) << limit_Hz;
  }
  options.band_limit_Hz = 5e3;
  for (const double stress_Pa : Reducer(options).reduce(shot).stress_Pa) {
    ASSERT_TRUE(std::isfinite(stress_Pa));
  }
}

TEST(ElasticReduction, TheSameShotGivesTheSameBitsWhateverCameBefore) {
  const ElasticShpb model;
  const Shot shot = model.shot(model.solve(), 4e-6, 16, 0.01, 7);
  const Reduction alone = Reducer().reduce(shot);
  ElasticShpb other;
  other.duration_s = 1.2e-3;
  other.gauge_to_A_m = 0.4;
  Reducer busy;
  (void)busy.reduce(other.shot(other.solve(), 20e-6, 12, 0.01, 3));
  const Reduction after = busy.reduce(shot);
  EXPECT_EQ(alone.stress_Pa, after.stress_Pa);
  EXPECT_EQ(alone.strain, after.strain);
  EXPECT_EQ(alone.time_s, after.time_s);
  EXPECT_EQ(alone.strain_rate_per_s, after.strain_rate_per_s);
}

TEST(ElasticReduction, AShotWithAHoleIsNotReduced) {
  const ElasticShpb model;
  Shot shot = noiseless(model, model.solve());
  shot.gaps.push_back({.first_tick = 700, .samples = 12, .known = true});
  const Reduction r = Reducer().reduce(shot);
  EXPECT_FALSE(r.quality.reducible);
  EXPECT_EQ(r.quality.verdict(), Verdict::fail);
  EXPECT_NE(r.quality.reason.find("12 samples are missing"), std::string::npos) << r.quality.reason;
  EXPECT_TRUE(r.stress_Pa.empty());
}

TEST(ElasticReduction, AClippedShotIsNotReduced) {
  const ElasticShpb model;
  const Shot shot = model.shot(model.solve(), 0.0, 16, 0.0009, 1);
  const Reduction r = Reducer().reduce(shot);
  EXPECT_FALSE(r.quality.reducible);
  EXPECT_NE(r.quality.reason.find("codes of g1"), std::string::npos) << r.quality.reason;
}

TEST(ElasticReduction, NoiseAloneHoldsNoPulse) {
  ElasticShpb model;
  model.pulse_strain = 0.0;
  const auto records = model.solve();
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Reduction r = Reducer().reduce(model.shot(records, 4e-6, 16, 0.01, seed));
    EXPECT_FALSE(r.quality.reducible) << seed;
    EXPECT_NE(r.quality.reason.find("no incident pulse"), std::string::npos) << r.quality.reason;
    EXPECT_FALSE(r.quality.mend.empty());
  }
}

TEST(ElasticReduction, AnOutputThatReadsNothingIsNoSignal) {
  const ElasticShpb model;
  auto records = model.solve();
  Shot shot = noiseless(model, records);
  std::ranges::fill(shot.channels.back().codes, shot.channels.back().codes.front());
  const Reduction r = Reducer().reduce(shot);
  EXPECT_EQ(check_of(r, "signal_to_noise").verdict, Verdict::fail);
  EXPECT_NE(check_of(r, "signal_to_noise").text.find("is it connected?"), std::string::npos);
  EXPECT_EQ(spectral_quality(shot, r).useful_band_Hz, 0.0);
}

TEST(ElasticReduction, ADurationOfNoSamplesIsToBlameByItself) {
  const ElasticShpb model;
  ReductionOptions options;
  options.duration_s = 1e-6;
  const Reduction r = Reducer(options).reduce(noiseless(model, model.solve()));
  EXPECT_FALSE(r.quality.reducible);
  EXPECT_NE(r.quality.reason.find("the duration asked for, 1 us"), std::string::npos)
      << r.quality.reason;
}

TEST(ElasticReduction, ARecordThatEndsTooEarlySaysSo) {
  ElasticShpb model;
  model.duration_s = 450e-6;
  const Reduction r = Reducer().reduce(noiseless(model, model.solve()));
  EXPECT_FALSE(r.quality.reducible);
  EXPECT_NE(r.quality.reason.find("ends before"), std::string::npos) << r.quality.reason;
  EXPECT_NE(r.quality.mend.find("record for longer"), std::string::npos) << r.quality.mend;
}

/// 25 mm from the specimen the reflection is back 10 us after the foot of a pulse that rises in 20.
TEST(ElasticReduction, APulseThatStillRisesWhenItsReflectionIsBackIsNotReduced) {
  ElasticShpb model;
  model.gauge_to_A_m = 0.025;
  const Reduction r = Reducer().reduce(noiseless(model, model.solve()));
  EXPECT_FALSE(r.quality.reducible);
  EXPECT_NE(r.quality.reason.find("while it still rises"), std::string::npos) << r.quality.reason;
  EXPECT_NE(r.quality.mend.find("further from the specimen than 0.025 m"), std::string::npos)
      << r.quality.mend;
}

TEST(ElasticReduction, APulseLongerThanTheGaugeAllowsIsNamed) {
  ElasticShpb model;
  model.pulse_s = 230e-6;  // the specimen answers after 195 us
  const Reduction r = Reducer().reduce(noiseless(model, model.solve()));
  EXPECT_EQ(check_of(r, "window_overlap").verdict, Verdict::fail);
  const std::string text = check_of(r, "window_overlap").text;
  EXPECT_NE(text.find("over within 195 us"), std::string::npos) << text;
  EXPECT_NE(text.find("2.6 mm for each us"), std::string::npos) << text;
  EXPECT_EQ(
      check_of(Reducer().reduce(noiseless({}, ElasticShpb{}.solve())), "window_overlap").verdict,
      Verdict::pass);
}

TEST(ElasticReduction, AGaugeFiledInTheWrongPlaceShowsInTheLag) {
  const ElasticShpb model;
  Shot shot = noiseless(model, model.solve());
  EXPECT_EQ(check_of(Reducer().reduce(shot), "front_back_lag").verdict, Verdict::pass);
  shot.bench.gauges[1].position_m = {0.340};  // 0.300 in truth: 7.8 us
  const Check lag = check_of(Reducer().reduce(shot), "front_back_lag");
  EXPECT_EQ(lag.verdict, Verdict::warn);
  EXPECT_NEAR(lag.value, -0.040 / std::sqrt(206e9 / 7850.0), 1e-6);
}

TEST(ElasticReduction, BenchesThatCannotBeReducedAreRefusedWithTheMend) {
  const ElasticShpb model;
  Shot shot = noiseless(model, model.solve());
  Shot no_output_gauge = shot;
  no_output_gauge.bench.gauges[1].bar = "input";
  EXPECT_THROW((void)Reducer().reduce(no_output_gauge), InputError);
  Shot bar = shot;
  bar.bench.kind = BenchKind::bar;
  EXPECT_THROW((void)Reducer().reduce(bar), InputError);
  Shot too_few = shot;
  too_few.channels.pop_back();
  EXPECT_THROW((void)Reducer().reduce(too_few), InputError);
}

}  // namespace
}  // namespace kolsky

// Feet given by hand, right and wrong, and records that end or were cut off before the reduction
// could tell.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "processing/base/error.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/validity.hpp"
#include "tests/generators/elastic_shpb.hpp"
#include "tests/generators/linear_shpb.hpp"
#include "tests/unit/reduction/ball_bench.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::check_of;

Shot bar_shot() {
  const testing::LinearShpb model;
  return testing::digitise(model.bench(), model.solve(), 4e-6, 16, 0.005, 1);
}

Shot ball_shot() {
  const testing::Push push;
  return testing::ball_shot(testing::ball_bench(),
                            [push](double time_s) { return push.force_N(time_s); });
}

Shot first_samples(Shot shot, std::size_t samples) {
  for (ChannelRecord& channel : shot.channels) channel.codes.resize(samples);
  return shot;
}

Reduction begun_at(const Shot& shot, double arrival_s) {
  ReductionOptions options;
  options.arrival_s = arrival_s;
  return Reducer(options).reduce(shot);
}

Reduction limited_to(const Shot& shot, double band_limit_Hz) {
  ReductionOptions options;
  options.band_limit_Hz = band_limit_Hz;
  return Reducer(options).reduce(shot);
}

double peak_Pa(const Reduction& r) {
  return *std::max_element(r.stress_Pa.begin(), r.stress_Pa.end());
}

// A front runs at sqrt(E1 / rho) of the paper's PMMA.
TEST(ManualFoot, CountsAtTheFirstGauge) {
  const Shot shot = bar_shot();
  const Reduction found = Reducer().reduce(shot);
  const double travel_s = shot.bench.distance_to_specimen_m(shot.bench.gauges.front()) /
                          std::sqrt(5.66e9 / shot.bench.input.density_kg_m3);
  const Reduction manual = begun_at(shot, found.arrival_s - travel_s);
  EXPECT_NEAR(manual.arrival_s, found.arrival_s, 1e-9);
  EXPECT_NEAR(peak_Pa(manual) / peak_Pa(found), 1.0, 1e-3);
}

TEST(ManualFoot, IsRefusedOffTheRecordOrFarFromAnyPulse) {
  for (const Shot& shot : {bar_shot(), ball_shot()}) {
    const double end_s = static_cast<double>(shot.samples()) * shot.rate.period_s();
    for (const double arrival_s :
         {-1.0, -1e-3, end_s, 99.0, 1e300, -std::numeric_limits<double>::infinity()}) {
      EXPECT_THROW((void)begun_at(shot, arrival_s), InputError) << arrival_s;
    }
    EXPECT_THROW((void)begun_at(shot, 0.0), InputError);
  }
}

// Whatever is given, a reduction ends in an answer or a refusal.
TEST(ManualFoot, AnywhereInTheRecordEndsInAnAnswer) {
  for (const Shot& shot : {bar_shot(), ball_shot()}) {
    int answers = 0;
    for (std::size_t n = 0; n < shot.samples(); n += 97) {
      const double arrival_s = static_cast<double>(n) * shot.rate.period_s();
      try {
        const Reduction r = begun_at(shot, arrival_s);
        ++answers;
        EXPECT_EQ(r.quality.reason.empty(), r.quality.reducible);
      } catch (const InputError& error) {
        EXPECT_EQ(error.place(), "arrival_s");
      }
    }
    EXPECT_GT(answers, 0);
  }
}

TEST(BandLimit, BeyondTheRecordIsRefused) {
  for (const Shot& shot : {bar_shot(), ball_shot()}) {
    EXPECT_NO_THROW((void)limited_to(shot, 40e3));
    EXPECT_THROW((void)limited_to(shot, 0.51 * shot.rate.Hz()), InputError);
  }
}

// Half the rate is in every record, whatever rounding makes of its transform's last frequency.
TEST(BandLimit, AtHalfTheRateIsTakenOfRecordsOfAnyLength) {
  for (const Shot& shot : {bar_shot(), ball_shot()}) {
    for (std::size_t n = 0; n < 12; ++n) {
      const Shot cut = first_samples(shot, shot.samples() - 31 * n);
      EXPECT_NO_THROW((void)limited_to(cut, 0.5 * shot.rate.Hz())) << cut.samples();
    }
  }
}

/// Of its histories.
std::size_t samples_until(const Reduction& r, double share_of_peak) {
  const double peak = peak_Pa(r);
  const auto found = std::find_if(r.stress_Pa.begin(), r.stress_Pa.end(),
                                  [&](double stress) { return stress > share_of_peak * peak; });
  return static_cast<std::size_t>(found - r.stress_Pa.begin());
}

TEST(RecordEnd, InTheLoadingFails) {
  const Shot whole = bar_shot();
  const Reduction all = Reducer().reduce(whole);
  ASSERT_EQ(check_of(all, "record_end").verdict, Verdict::pass);
  const auto arrival = static_cast<std::size_t>(all.arrival_s * whole.rate.Hz());
  // Half way up, as told by the whole record; gauges see it a travel later.
  const std::size_t half_way = arrival + samples_until(all, 0.7);
  bool failed = false;
  for (std::size_t samples = half_way; samples < whole.samples(); samples += 20) {
    const Reduction part = Reducer().reduce(first_samples(whole, samples));
    if (!part.quality.reducible) continue;
    const bool peak_missing = peak_Pa(part) < 0.95 * peak_Pa(all);
    if (peak_missing) {
      failed = true;
      EXPECT_EQ(check_of(part, "record_end").verdict, Verdict::fail) << samples;
      EXPECT_EQ(part.quality.verdict(), Verdict::fail);
    }
  }
  EXPECT_TRUE(failed);
}

TEST(RecordEnd, SaysWhatAnAskedDurationLacks) {
  const Shot shot = bar_shot();
  ReductionOptions options;
  options.duration_s = 5.0;
  const Reduction r = Reducer(options).reduce(shot);
  EXPECT_EQ(check_of(r, "record_end").verdict, Verdict::warn);
  EXPECT_NE(check_of(r, "record_end").text.find("too soon"), std::string::npos);
}

// A wave under a gauge where the record ends is cut there, and the low-pass looks ahead.
TEST(RecordEnd, CutsNoStepIntoTheHistories) {
  testing::ElasticShpb model;
  model.sampling_frequency_Hz = 2e6;
  const auto records = model.solve();
  const Shot whole = model.shot(records, 0.0, 24, 0.01, 1);
  const double peak_N =
      *std::max_element(records.truth.force_N.begin(), records.truth.force_N.begin() + 20'000);
  int ends = 0;
  // The reflected pulse is under the input gauge from 492 to 592 us.
  for (std::size_t samples = 1080; samples < 1180; samples += 3) {
    const Reduction r = Reducer().reduce(first_samples(whole, samples));
    if (!r.quality.reducible) continue;
    ++ends;
    for (std::size_t n = r.time_s.size() - 8; n < r.time_s.size(); ++n) {
      const double t = r.time_s[n] + r.arrival_s - records.truth.arrival_s;
      EXPECT_NEAR(r.force_front_N[n], records.truth.at(records.truth.force_N, t), 0.02 * peak_N)
          << samples;
    }
  }
  EXPECT_GT(ends, 20);
}

Shot begun_late(Shot shot, std::ptrdiff_t samples) {
  for (ChannelRecord& channel : shot.channels) {
    channel.codes.erase(channel.codes.begin(), channel.codes.begin() + samples);
  }
  return shot;
}

// A trigger that came late: what follows from that is not what is said first.
TEST(RecordBeginning, WithinThePulseLeadsAllReasons) {
  const testing::ElasticShpb elastic;
  int judged = 0;
  int behind = 0;
  for (const Shot& whole : {elastic.shot(elastic.solve(), 4e-6, 16, 0.01, 1), bar_shot()}) {
    // The pulse's foot is at the gauge a front's way before it is at the specimen.
    const Reduction all = Reducer().reduce(whole);
    const Bar& bar = whole.bench.input;
    const double speed = std::sqrt((bar.youngs_modulus_Pa ? bar.youngs_modulus_Pa->value : 5.66e9) /
                                   bar.density_kg_m3);
    const double foot_s =
        all.arrival_s - whole.bench.distance_to_specimen_m(whole.bench.gauges.front()) / speed;
    const auto foot = static_cast<std::ptrdiff_t>(foot_s * whole.rate.Hz());
    for (std::ptrdiff_t late = foot - 5; late < foot + 60; ++late) {
      const Reduction r = Reducer().reduce(begun_late(whole, late));
      if (r.quality.reducible && r.quiet_samples == 0) {
        ++judged;
        EXPECT_EQ(r.quality.checks.front().name, "quiet_start") << late;
        EXPECT_EQ(r.quality.checks.front().verdict, Verdict::fail);
        EXPECT_EQ(quotable_part(r).text.find("no part of the curve: the record begins within"), 0U);
      } else if (r.quality.reducible && r.quiet_samples < 32) {
        // Its slow beginning is left out; a few samples of that are taken for the baseline.
        EXPECT_EQ(check_of(r, "quiet_start").verdict, Verdict::warn) << late - foot;
      } else {
        // Its fall, or what comes back, is taken for the pulse: of the other sign.
        ++behind;
        const Check* sign = r.quality.find("gauge_sign");
        const std::string& told = sign != nullptr ? sign->text : r.quality.mend;
        EXPECT_NE(told.find("begins within"), std::string::npos)
            << late - foot << ": " << r.quality.reason << "; " << told;
      }
    }
  }
  EXPECT_GT(judged, 4);
  EXPECT_GT(behind, 20);
}

Shot as_a_table(Shot shot, std::int32_t cut_at) {
  for (ChannelRecord& channel : shot.channels) {
    channel.code_min = std::numeric_limits<std::int32_t>::min();
    channel.code_max = std::numeric_limits<std::int32_t>::max();
    for (std::int32_t& code : channel.codes) code = std::clamp(code, -cut_at, cut_at);
  }
  return shot;
}

TEST(FlatTop, OfATableIsNotCalledUnclipped) {
  const Shot shot = bar_shot();
  std::int32_t most = 0;
  for (const std::int32_t code : shot.channels[0].codes) most = std::max(most, std::abs(code));
  const Reduction cut = Reducer().reduce(as_a_table(shot, most / 2));
  EXPECT_EQ(check_of(cut, "clipping").verdict, Verdict::warn);
  EXPECT_GE(check_of(cut, "clipping").value, 10.0);
  const Reduction whole = Reducer().reduce(as_a_table(shot, 2 * most));
  EXPECT_EQ(check_of(whole, "clipping").verdict, Verdict::pass);
  EXPECT_NE(check_of(whole, "clipping").text.find("table"), std::string::npos);
  EXPECT_EQ(check_of(Reducer().reduce(shot), "clipping").text.find("table"), std::string::npos);
}

}  // namespace
}  // namespace kolsky

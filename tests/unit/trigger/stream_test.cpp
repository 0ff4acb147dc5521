#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/trigger/incident_trigger.hpp"
#include "tests/unit/trigger/signals.hpp"

namespace kolsky {
namespace {

using Codes = std::vector<std::int16_t>;

constexpr double kNoise = 20.0;

double time_of(const TriggerEvent& event) {
  return static_cast<double>(event.tick) + event.fraction;
}

Codes draw(
    const signals::Background& background, std::size_t samples, std::uint64_t seed,
    const std::function<double(double)>& added = [](double) { return 0.0; }) {
  signals::Source source(background, seed);
  Codes codes(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    codes[i] = signals::quantised(source.next() + added(static_cast<double>(i)));
  }
  return codes;
}

/// A pulse with its foot at a sample.
std::function<double(double)> pulse_at(double foot, const signals::Pulse& pulse) {
  return [=](double sample) { return pulse.at(sample - foot); };
}

template <class Code>
void feed_all(IncidentTrigger& trigger, const std::vector<Code>& codes,
              const std::function<std::size_t()>& next_size, std::vector<TriggerEvent>& events,
              Tick first = 0) {
  const std::span<const Code> all(codes);
  for (std::size_t at = 0; at < all.size();) {
    const auto block = all.subspan(at, std::min(next_size(), all.size() - at));
    if (const auto event =
            trigger.feed(first + static_cast<Tick>(at), block, run_statistics(block))) {
      events.push_back(*event);
    }
    at += block.size();
  }
  // Those that wait come with runs of nothing.
  const auto end = first + static_cast<Tick>(all.size());
  while (const auto event = trigger.feed(end, all.first(0), {})) events.push_back(*event);
}

template <class Code>
std::vector<TriggerEvent> events_of(const std::vector<Code>& codes,
                                    const TriggerOptions& options = {}, std::size_t block = 4096) {
  IncidentTrigger trigger(options);
  std::vector<TriggerEvent> events;
  feed_all(
      trigger, codes, [=] { return block; }, events);
  return events;
}

TEST(IncidentTrigger, TellsWhenAPulseOfEitherSignCrossedTheLevel) {
  for (const double peak : {-3000.0, 3000.0}) {
    const signals::Pulse pulse{std::abs(peak), 30.0, 170.0};
    const Codes codes = draw({.noise_codes = kNoise, .offset_codes = 777.0}, 20'000, 1,
                             [&](double t) { return (peak < 0 ? -1 : 1) * pulse.at(t - 9000.4); });
    const auto events = events_of(codes);
    ASSERT_EQ(events.size(), 1U);
    EXPECT_NEAR(time_of(events[0]), 9000.4 + pulse.reaches(8.0 * kNoise),
                4.0 * events[0].sigma_samples);
    EXPECT_LT(events[0].sigma_samples, 0.5);
    EXPECT_GT(events[0].sigma_samples, 0.05);
    EXPECT_EQ(events[0].kind, TriggerKind::incident);
  }
}

TEST(IncidentTrigger, FindsTheSameInThirtyTwoBitCodes) {
  const Codes narrow =
      draw({.noise_codes = kNoise}, 20'000, 2, pulse_at(9000.4, {3000.0, 30.0, 170.0}));
  const std::vector<std::int32_t> wide(narrow.begin(), narrow.end());
  ASSERT_EQ(events_of(narrow).size(), 1U);
  EXPECT_EQ(events_of(narrow), events_of(wide));

  // 24 bits, beyond what 16 could hold: 256 times the codes.
  std::vector<std::int32_t> wider(wide);
  for (std::int32_t& code : wider) code *= 256;
  const auto events = events_of(wider);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(time_of(events[0]), time_of(events_of(narrow)[0]), 1e-3);
}

TEST(IncidentTrigger, FindsTheSameHoweverTheStreamIsCut) {
  const signals::Background background{.noise_codes = kNoise,
                                       .hum_codes = 60 * kNoise,
                                       .spikes = 5e-4,
                                       .spike_codes = 300 * kNoise,
                                       .spike_samples = 4,
                                       .offset_codes = -300.0};
  TriggerOptions options;
  options.hold_off_samples = 3000;
  const Codes codes = draw(background, 300'000, 4, [](double t) {
    // Strong, weak and hopeless pulses.
    const double since = std::fmod(t, 33'000.0) - 7000.37;
    const double peak =
        kNoise * std::array{100.0, 14.0, 11.0, 6.0}[static_cast<std::size_t>(t / 33'000.0) % 4];
    return signals::Pulse{peak, 30.0, 170.0}.at(since);
  });
  const auto whole = events_of(codes, options, codes.size());
  EXPECT_GE(whole.size(), 5U);
  EXPECT_LE(whole.size(), 8U) << "more would not all be kept for the next calls";
  for (const std::size_t block : {1UL, 64UL, 100UL, 128UL, 1000UL, 65'536UL}) {
    EXPECT_EQ(events_of(codes, options, block), whole) << "blocks of " << block;
  }
  std::mt19937 random(5);
  for (int round = 0; round < 5; ++round) {
    IncidentTrigger trigger(options);
    std::vector<TriggerEvent> events;
    std::uniform_int_distribution<std::size_t> size(1, round < 3 ? 700 : 70'000);
    feed_all(
        trigger, codes, [&] { return size(random); }, events);
    EXPECT_EQ(events, whole);
  }
}

TEST(IncidentTrigger, TakesItsOwnStatisticsWhereItIsGivenNone) {
  const Codes codes = draw({.noise_codes = kNoise, .spikes = 1e-3, .spike_codes = 30'000.0}, 20'000,
                           2, pulse_at(9000.4, {3000.0, 30.0, 170.0}));
  IncidentTrigger trigger{TriggerOptions{}};
  const auto event = trigger.feed(0, codes, RunStatistics{});
  ASSERT_TRUE(event);
  EXPECT_EQ(*event, events_of(codes).at(0));
}

TEST(IncidentTrigger, TellsSeveralTriggersOfOneRunOneByOne) {
  TriggerOptions options;
  options.hold_off_samples = 1000;
  const signals::Pulse pulse{3000.0, 30.0, 170.0};
  const Codes codes = draw({.noise_codes = kNoise}, 20'000, 6,
                           [&](double t) { return pulse.at(std::fmod(t, 4000.0) - 2000.5); });
  const auto events = events_of(codes, options, codes.size());
  ASSERT_EQ(events.size(), 5U);
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_NEAR(time_of(events[i]), 4000.0 * static_cast<double>(i) + 2000.5 + pulse.reaches(160.0),
                2.0);
  }
}

TEST(IncidentTrigger, IsNotFiredBySpikesShorterThanTheWidth) {
  const TriggerOptions options;
  const auto spike_of = [&](double samples) {
    return draw({.noise_codes = kNoise}, 12'000, 7, [=](double t) {
      return t >= 8000.0 && t < 8000.0 + samples ? 1000.0 * kNoise : 0.0;
    });
  };
  const auto width = static_cast<double>(options.minimum_width_samples);
  for (double samples = 1.0; samples < width; ++samples) {
    EXPECT_TRUE(events_of(spike_of(samples)).empty()) << samples;
  }
  EXPECT_EQ(events_of(spike_of(width)).size(), 1U);
}

TEST(IncidentTrigger, IsNotFiredByARingingDisturbance) {
  const Codes codes = draw({.noise_codes = kNoise}, 12'000, 8, [](double t) {
    return t < 8000.0 ? 0.0 : 200.0 * kNoise * std::exp(-(t - 8000.0) / 15.0) * std::sin(0.9 * t);
  });
  EXPECT_TRUE(events_of(codes).empty());
}

TEST(IncidentTrigger, IsNotFiredByHumUpToAThousandSigmaAndFindsPulsesInIt) {
  for (const double hum : {5.0, 30.0, 100.0, 300.0, 1000.0}) {
    SCOPED_TRACE(hum);
    const signals::Background background{.noise_codes = kNoise, .hum_codes = hum * kNoise};
    for (std::uint64_t seed = 0; seed < 8; ++seed) {  // as many phases to begin at
      EXPECT_TRUE(events_of(draw(background, 100'000, seed)).empty()) << seed;
    }
    const double peak = hum <= 100.0 ? 25.0 : 300.0;
    const signals::Pulse pulse{peak * kNoise, 30.0, 170.0};
    for (const double foot : {53'000.0, 58'000.0, 63'000.0}) {
      const auto events = events_of(draw(background, 80'000, 3, pulse_at(foot, pulse)));
      ASSERT_EQ(events.size(), 1U) << foot;
      EXPECT_NEAR(time_of(events[0]), foot + pulse.reaches(8.0 * kNoise), 12.0);
    }
  }
}

TEST(IncidentTrigger, IsNotFiredByDriftNorByARiseSlowerThanItsLimit) {
  // The limit is 4 sigma, from the band to the level, in 40 samples; noise blurs it by some 2
  // sigma.
  const auto ramp = [](double per_sample) {
    return draw({.noise_codes = kNoise}, 20'000, 12, [=](double t) {
      return kNoise * per_sample * std::clamp(t - 9000.0, 0.0, 1000.0);
    });
  };
  EXPECT_TRUE(events_of(ramp(1.5 / 40.0)).empty());
  EXPECT_EQ(events_of(ramp(8.0 / 40.0)).size(), 1U);
  const signals::Background drift{
      .noise_codes = kNoise, .hum_codes = 1000 * kNoise, .hum_period = 2e6};
  EXPECT_TRUE(events_of(draw(drift, 2'000'000, 13)).empty());
}

TEST(IncidentTrigger, IsNotFiredByASingleCodeOfAConstantRecord) {
  Codes codes(10'000, 5);
  EXPECT_TRUE(events_of(codes).empty());
  std::fill(codes.begin() + 4000, codes.begin() + 6000, std::int16_t{6});
  std::fill(codes.begin() + 7000, codes.end(), std::int16_t{3});
  EXPECT_TRUE(events_of(codes).empty());
  for (std::size_t i = 8000; i < 8100; ++i) codes[i] = 30;
  EXPECT_EQ(events_of(codes).size(), 1U);
}

TEST(IncidentTrigger, IsNotFiredByNoiseBelowOneCode) {
  for (const double offset : {0.0, 0.3, 0.5}) {
    const Codes codes =
        draw({.noise_codes = 0.3, .hum_codes = 2.0, .offset_codes = offset}, 500'000, 14);
    EXPECT_TRUE(events_of(codes).empty()) << offset;
  }
}

TEST(IncidentTrigger, FindsAPulseRightAfterLearning) {
  const TriggerOptions options;
  const signals::Pulse pulse{3000.0, 30.0, 170.0};
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const double foot = static_cast<double>(options.learn_samples) - 1.0;
    const auto events = events_of(draw({.noise_codes = kNoise}, 4000, seed, pulse_at(foot, pulse)));
    ASSERT_EQ(events.size(), 1U) << seed;
    EXPECT_NEAR(time_of(events[0]), foot + pulse.reaches(8.0 * kNoise),
                4.0 * events[0].sigma_samples);
  }
}

TEST(IncidentTrigger, FindsAPulseAfterASpikeSpoiltLearning) {
  Codes codes = draw({.noise_codes = kNoise}, 4000, 15, pulse_at(400.0, {2000.0, 30.0, 170.0}));
  codes[100] = 32767;
  codes[101] = -32768;
  EXPECT_EQ(events_of(codes).size(), 1U);
}

TEST(IncidentTrigger, WorksForTheSameTimesAtEveryRate) {
  struct Case {
    double rate_Hz, before_s, rise_s, length_s;
  };
  // As imported captures come: scopes with 50 to 80 us before the pulse, digitisers with 400
  // samples.
  for (const Case& c : {Case{0.4e6, 1e-3, 30e-6, 170e-6}, Case{1e6, 400e-6, 30e-6, 170e-6},
                        Case{1e6, 400e-6, 60e-6, 170e-6}, Case{5e6, 100e-6, 20e-6, 170e-6},
                        Case{10e6, 50e-6, 8e-6, 60e-6}, Case{31.25e6, 80e-6, 15e-6, 100e-6},
                        Case{125e6, 80e-6, 1.5e-6, 10e-6}}) {
    SCOPED_TRACE(testing::Message() << c.rate_Hz << " Hz, rise " << c.rise_s);
    const double foot = c.before_s * c.rate_Hz;
    const signals::Pulse pulse{100.0 * kNoise, c.rise_s * c.rate_Hz, c.length_s * c.rate_Hz};
    const auto samples = static_cast<std::size_t>(foot + 3.0 * pulse.length);
    double worst = 0.0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      const auto events =
          events_of(draw({.noise_codes = kNoise}, samples, seed, pulse_at(foot, pulse)),
                    TriggerOptions::for_rate(c.rate_Hz));
      ASSERT_EQ(events.size(), 1U) << seed;
      const double error = time_of(events[0]) - foot - pulse.reaches(8.0 * kNoise);
      worst = std::max(worst, std::abs(error) / events[0].sigma_samples);
      EXPECT_LT(events[0].sigma_samples / c.rate_Hz, 1e-6);
    }
    EXPECT_LT(worst, 4.0);
  }
}

TEST(IncidentTrigger, HoldsOffAndThenFindsTheNextPulse) {
  TriggerOptions options;
  options.hold_off_samples = 10'000;
  const signals::Pulse pulse{3000.0, 30.0, 170.0};
  const Codes codes = draw({.noise_codes = kNoise}, 40'000, 16, [&](double t) {
    return pulse.at(t - 5000.0) + pulse.at(t - 9000.0) - pulse.at(t - 12'000.0) +
           pulse.at(t - 20'000.0);
  });
  const auto events = events_of(codes, options);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_NEAR(time_of(events[0]), 5000.0, 30.0);
  EXPECT_NEAR(time_of(events[1]), 20'000.0, 30.0);
}

TEST(IncidentTrigger, HoldsOffOverAHoleButNotIntoAStreamThatBeginsAnew) {
  TriggerOptions options;
  options.hold_off_samples = 50'000;
  const signals::Pulse pulse{3000.0, 30.0, 170.0};
  const Codes codes = draw({.noise_codes = kNoise}, 10'000, 22, pulse_at(5000.0, pulse));
  IncidentTrigger trigger(options);
  std::vector<TriggerEvent> events;
  const auto size = [] { return 1000UL; };
  feed_all(trigger, codes, size, events);
  ASSERT_EQ(events.size(), 1U);
  feed_all(trigger, codes, size, events, 20'000);
  EXPECT_EQ(events.size(), 1U) << "within the hold-off of the first";
  feed_all(trigger, codes, size, events, 60'000);
  EXPECT_EQ(events.size(), 2U);
  feed_all(trigger, codes, size, events, 0);
  EXPECT_EQ(events.size(), 3U) << "ticks that begin anew know no hold-off";
}

TEST(IncidentTrigger, GetsOverAStepOfTheBaseline) {
  TriggerOptions options;
  options.hold_off_samples = 2000;
  const signals::Pulse pulse{3000.0, 30.0, 170.0};
  const Codes codes = draw({.noise_codes = kNoise}, 40'000, 17, [&](double t) {
    return (t > 8000.0 ? 5000.0 : 0.0) + pulse.at(t - 30'000.0);
  });
  const auto events = events_of(codes, options);
  ASSERT_EQ(events.size(), 2U) << "the step itself, then the pulse upon it";
  EXPECT_NEAR(time_of(events[1]), 30'000.0 + pulse.reaches(160.0), 2.0);
}

TEST(IncidentTrigger, FollowsNoiseThatGrowsAndFalls) {
  IncidentTrigger trigger{TriggerOptions{}};
  std::vector<TriggerEvent> events;
  Tick first = 0;
  for (const double noise : {20.0, 60.0, 15.0}) {
    feed_all(
        trigger, draw({.noise_codes = noise}, 400'000, 18), [] { return 4096UL; }, events, first);
    first += 400'000;
    EXPECT_NEAR(trigger.noise_codes(), noise, 0.05 * noise);
    EXPECT_NEAR(trigger.level_codes(), 8.0 * noise, 0.4 * noise);
    EXPECT_TRUE(trigger.ready());
  }
  EXPECT_TRUE(events.empty());
}

TEST(IncidentTrigger, KeepsTheNoiseOverAHoleAndForgetsItForAnotherCapture) {
  IncidentTrigger trigger{TriggerOptions{}};
  EXPECT_FALSE(trigger.ready());
  std::vector<TriggerEvent> events;
  const Codes quiet = draw({.noise_codes = kNoise, .offset_codes = 500.0}, 50'000, 19);
  feed_all(
      trigger, quiet, [] { return 1000UL; }, events);
  ASSERT_TRUE(trigger.ready());
  const double noise = trigger.noise_codes();
  trigger.reset_run();
  EXPECT_FALSE(trigger.ready());
  EXPECT_EQ(trigger.noise_codes(), noise);
  EXPECT_NEAR(trigger.baseline_codes(), 500.0, 10.0);

  feed_all(
      trigger, Codes(quiet.begin(), quiet.begin() + 100), [] { return 100UL; }, events, 70'000);
  EXPECT_FALSE(trigger.ready()) << "100 samples are too few to know where the baseline is now";
  feed_all(
      trigger, Codes(quiet.begin() + 100, quiet.begin() + 300), [] { return 200UL; }, events,
      70'100);
  EXPECT_TRUE(trigger.ready());
  EXPECT_NEAR(trigger.noise_codes(), noise, 0.05 * noise);

  trigger.reset();
  EXPECT_FALSE(trigger.ready());
  EXPECT_EQ(trigger.baseline_codes(), 0.0);
  EXPECT_TRUE(events.empty());
}

TEST(IncidentTrigger, IsNotFiredByWhatHappensInAHole) {
  // Without the hole this would be a step; hum and offset go on unseen while samples are missing.
  IncidentTrigger trigger{TriggerOptions{}};
  std::vector<TriggerEvent> events;
  Tick first = 0;
  for (int run = 0; run < 20; ++run) {
    const double offset = run % 2 == 0 ? 0.0 : 4000.0;
    feed_all(
        trigger, draw({.noise_codes = kNoise, .offset_codes = offset}, 3000, 20),
        [] { return 500UL; }, events, first);
    first += 3000 + 777;
  }
  EXPECT_TRUE(events.empty());
}

TEST(IncidentTrigger, StillTellsOfAPulseThatAHoleCutsShort) {
  const signals::Pulse pulse{100.0 * kNoise, 30.0, 170.0};
  const Codes codes = draw({.noise_codes = kNoise}, 20'000, 21, pulse_at(9000.0, pulse));
  IncidentTrigger trigger{TriggerOptions{}};
  std::vector<TriggerEvent> events;
  const double crossing = 9000.0 + pulse.reaches(8.0 * kNoise);
  const auto hole =
      static_cast<std::ptrdiff_t>(crossing) + 7;  // the width is full, the fit still waits
  feed_all(
      trigger, Codes(codes.begin(), codes.begin() + hole), [] { return 512UL; }, events);
  ASSERT_TRUE(events.empty());
  feed_all(
      trigger, Codes(codes.begin() + hole + 300, codes.end()), [] { return 512UL; }, events,
      hole + 300);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(time_of(events[0]), crossing, 4.0 * events[0].sigma_samples);
}

struct Background {
  const char* name;
  signals::Background background;
  std::size_t quiet;  ///< samples before the pulse
};

void PrintTo(const Background& background, std::ostream* stream) {
  *stream << background.name;
}

class HonestSigma : public testing::TestWithParam<Background> {};

// Each repeat learns anew, so that what is not known of baseline and level is in the scatter too.
TEST_P(HonestSigma, IsTheScatterOverRepeats) {
  constexpr int kRepeats = 600;
  for (const double peak : {15.0, 60.0, 250.0}) {
    const signals::Pulse pulse{peak * kNoise, 30.0, 170.0};
    const auto quiet = static_cast<double>(GetParam().quiet);
    double sum = 0.0, square = 0.0, stated = 0.0;
    for (int repeat = 0; repeat < kRepeats; ++repeat) {
      const double foot = quiet + 0.37 * (repeat % 100) / 37.0;
      const auto events =
          events_of(draw(GetParam().background, GetParam().quiet + 400,
                         static_cast<std::uint64_t>(repeat), pulse_at(foot, pulse)));
      ASSERT_EQ(events.size(), 1U) << peak << ", repeat " << repeat;
      const double error = time_of(events[0]) - foot - pulse.reaches(8.0 * kNoise);
      sum += error;
      square += error * error;
      stated += events[0].sigma_samples * events[0].sigma_samples;
    }
    const double bias = sum / kRepeats;
    const double scatter = std::sqrt(square / kRepeats - bias * bias);
    const double sigma = std::sqrt(stated / kRepeats);
    EXPECT_NEAR(scatter / sigma, 1.0, 0.15) << peak;
    EXPECT_LT(std::abs(bias), 0.5 * sigma) << peak;
    RecordProperty("scatter_" + std::to_string(static_cast<int>(peak)), std::to_string(scatter));
    RecordProperty("stated_" + std::to_string(static_cast<int>(peak)), std::to_string(sigma));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Backgrounds, HonestSigma,
    testing::Values(Background{"white, just learned", {.noise_codes = kNoise}, 400},
                    Background{"white", {.noise_codes = kNoise}, 6000},
                    Background{"coloured", {.noise_codes = kNoise, .memory = 0.53}, 6000},
                    Background{"hum", {.noise_codes = kNoise, .hum_codes = 20 * kNoise}, 6000}),
    [](const auto& tested) { return "case" + std::to_string(tested.index); });

TEST(TriggerOptions, ScaleWithTheRate) {
  const auto at_1MHz = TriggerOptions::for_rate(1e6);
  const TriggerOptions defaults;
  EXPECT_EQ(at_1MHz.minimum_width_samples, defaults.minimum_width_samples);
  EXPECT_EQ(at_1MHz.maximum_rise_samples, defaults.maximum_rise_samples);
  EXPECT_EQ(at_1MHz.hold_off_samples, defaults.hold_off_samples);
  EXPECT_EQ(at_1MHz.learn_samples, defaults.learn_samples);
  EXPECT_EQ(at_1MHz.baseline_memory_samples, defaults.baseline_memory_samples);
  EXPECT_EQ(at_1MHz.noise_memory_samples, defaults.noise_memory_samples);
  const auto at_100MHz = TriggerOptions::for_rate(100e6);
  EXPECT_EQ(at_100MHz.minimum_width_samples, 500U);
  EXPECT_EQ(at_100MHz.maximum_rise_samples, 4000U);
  EXPECT_EQ(at_100MHz.learn_samples, 2500U);
  for (const double rate : {1.0, 1e3, 1e5, 1e6, 1e8, 1e10}) {
    EXPECT_NO_THROW(check(TriggerOptions::for_rate(rate))) << rate;
  }
}

TEST(TriggerOptions, RefuseRatesThatAreNone) {
  for (const double rate : {0.0, -1e6, std::nan(""), HUGE_VAL, 1e11}) {
    EXPECT_THROW((void)TriggerOptions::for_rate(rate), InputError) << rate;
  }
}

TEST(TriggerOptions, RefuseEachSettingThatCannotWorkByName) {
  const auto refused = [](const char* name, const std::function<void(TriggerOptions&)>& spoil) {
    TriggerOptions options;
    spoil(options);
    try {
      const IncidentTrigger trigger(options);
      ADD_FAILURE() << name << " was taken";
    } catch (const InputError& error) {
      EXPECT_EQ(error.place(), name);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  };
  refused("level_sigma", [](auto& o) { o.level_sigma = 0.0; });
  refused("level_sigma", [](auto& o) { o.level_sigma = std::nan(""); });
  refused("hysteresis_share", [](auto& o) { o.hysteresis_share = 1.0; });
  refused("minimum_width_samples", [](auto& o) { o.minimum_width_samples = 0; });
  refused("maximum_rise_samples", [](auto& o) { o.maximum_rise_samples = 2; });
  refused("learn_samples", [](auto& o) { o.learn_samples = 10; });
  refused("minimum_noise_codes", [](auto& o) { o.minimum_noise_codes = 0.0; });
  refused("baseline_memory_samples", [](auto& o) { o.baseline_memory_samples = 0; });
  refused("noise_memory_samples", [](auto& o) { o.noise_memory_samples = 0; });
}

}  // namespace
}  // namespace kolsky

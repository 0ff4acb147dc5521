#include "drivers/simulated/front_end.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>

#include "drivers/files/settings/bench_file.hpp"
#include "drivers/simulated/capture_source.hpp"
#include "drivers/simulated/digitiser_setup.hpp"
#include "drivers/simulated/scenario_source.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr SampleRate kMegahertz{1'000'000, 1};

FrontEndSettings silent() {
  FrontEndSettings settings;
  settings.noise_microstrain = 0.0;
  settings.hum_microstrain = 0.0;
  settings.offset_microstrain = 0.0;
  return settings;
}

std::vector<std::int32_t> convert(const FrontEndSettings& settings, std::size_t channel, Tick first,
                                  std::vector<double> strain, SampleRate rate = kMegahertz) {
  FrontEnd front_end(settings, channel);
  std::vector<std::int32_t> codes(strain.size());
  front_end.convert(first, rate, strain, codes);
  return codes;
}

struct Moments {
  double mean = 0.0;
  double rms = 0.0;
  double neighbours = 0.0;  ///< correlation of each number with the next
};

Moments moments(const std::vector<double>& values) {
  Moments m;
  for (const double v : values) {
    m.mean += v / static_cast<double>(values.size());
  }
  double square = 0.0;
  double product = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    square += (values[i] - m.mean) * (values[i] - m.mean);
    if (i > 0) {
      product += (values[i] - m.mean) * (values[i - 1] - m.mean);
    }
  }
  m.rms = std::sqrt(square / static_cast<double>(values.size()));
  m.neighbours = product / square;
  return m;
}

TEST(Noise, IsWhiteGaussianOfUnitVariance) {
  std::vector<double> numbers(1'000'000, 0.0);
  NoiseStream(7, 0).add(0, 1.0, numbers);
  const Moments m = moments(numbers);
  // Four standard errors of a million numbers.
  EXPECT_NEAR(m.mean, 0.0, 0.004);
  EXPECT_NEAR(m.rms, 1.0, 0.003);
  EXPECT_NEAR(m.neighbours, 0.0, 0.004);
  for (const auto& [sigmas, share] : std::map<double, double>{{1.0, 0.31731}, {3.0, 0.0026998}}) {
    std::size_t beyond = 0;
    for (const double v : numbers) {
      beyond += std::abs(v) > sigmas ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(beyond) / 1e6, share, 4.0 * std::sqrt(share / 1e6));
  }
}

TEST(Noise, IsTheSameHoweverItIsCut) {
  std::vector<double> whole(5000, 0.0);
  NoiseStream(7, 3).add(123, 2.0, whole);
  std::vector<double> cut(5000, 0.0);
  NoiseStream stream(7, 3);
  for (std::size_t at = 0, piece = 1; at < cut.size(); at += piece, piece = (piece * 7 + 3) % 611) {
    const std::size_t count = std::min(piece, cut.size() - at);
    stream.add(123 + static_cast<Tick>(at), 2.0, std::span(cut).subspan(at, count));
  }
  EXPECT_EQ(whole, cut);
}

TEST(Noise, DiffersByChannelAndSeed) {
  std::vector<double> one(100000, 0.0);
  std::vector<double> other(100000, 0.0);
  std::vector<double> third(100000, 0.0);
  NoiseStream(7, 0).add(0, 1.0, one);
  NoiseStream(7, 1).add(0, 1.0, other);
  NoiseStream(8, 0).add(0, 1.0, third);
  double with_other = 0.0;
  double with_third = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    with_other += one[i] * other[i] / 1e5;
    with_third += one[i] * third[i] / 1e5;
  }
  EXPECT_NEAR(with_other, 0.0, 0.013);
  EXPECT_NEAR(with_third, 0.0, 0.013);
}

class Resolution : public ::testing::TestWithParam<int> {};

TEST_P(Resolution, RoundsToTheNearestCodeAndClips) {
  FrontEndSettings settings = silent();
  settings.bits = GetParam();
  const double step = 2.0 * 2000e-6 / std::pow(2.0, GetParam());
  const auto highest = static_cast<std::int32_t>((1 << (GetParam() - 1)) - 1);
  const std::vector<std::int32_t> codes =
      convert(settings, 0, 0, {0.0, 10.4 * step, -10.4 * step, 10.6 * step, 1.0, -1.0, 1999.9e-6});
  EXPECT_EQ(codes[0], 0);
  EXPECT_EQ(codes[1], 10);
  EXPECT_EQ(codes[2], -10);
  EXPECT_EQ(codes[3], 11);
  EXPECT_EQ(codes[4], highest);
  EXPECT_EQ(codes[5], -highest - 1);
  EXPECT_NEAR(codes[6] * settings.strain_per_code(), 1999.9e-6, step);
  EXPECT_NEAR(settings.volts_per_code() * settings.strain_per_V(), settings.strain_per_code(),
              1e-15 * settings.strain_per_code());
}

INSTANTIATE_TEST_SUITE_P(Bits, Resolution, ::testing::Values(12, 14, 16, 18, 20, 24));

TEST(FrontEnd, AddsOffsetHumAndDriftAtTheirStrength) {
  FrontEndSettings settings = silent();
  settings.bits = 24;
  settings.offset_microstrain = 20.0;
  settings.hum_microstrain = 5.0;
  const std::vector<double> quiet(200'000, 0.0);  // ten periods of the hum
  for (const std::size_t channel : {0U, 1U}) {
    const std::vector<std::int32_t> codes = convert(settings, channel, 12345, quiet);
    std::vector<double> strain;
    double projection_sin = 0.0;
    double projection_cos = 0.0;
    for (std::size_t i = 0; i < codes.size(); ++i) {
      strain.push_back(codes[i] * settings.strain_per_code() * 1e6);
      const double angle = 2.0 * M_PI * 50.0 * static_cast<double>(i) * 1e-6;
      projection_sin += strain.back() * std::sin(angle) * 2.0 / 200'000;
      projection_cos += strain.back() * std::cos(angle) * 2.0 / 200'000;
    }
    EXPECT_NEAR(moments(strain).mean, channel == 0 ? 20.0 : -20.0, 1e-3);
    EXPECT_NEAR(std::hypot(projection_sin, projection_cos), 5.0, 1e-3);
  }
  FrontEndSettings drifting = silent();
  drifting.drift_microstrain = 100.0;
  drifting.drift_period_s = 4.0;
  double least = 1e9;
  double most = -1e9;
  for (Tick second = 0; second < 40; ++second) {
    const std::int32_t code = convert(drifting, 0, second * 100'000, {0.0})[0];
    least = std::min(least, code * drifting.strain_per_code() * 1e6);
    most = std::max(most, code * drifting.strain_per_code() * 1e6);
  }
  EXPECT_NEAR(most - least, 200.0, 3.0);
}

TEST(FrontEnd, OffsetCodesAreUndoneByTheirAttribute) {
  FrontEndSettings settings = silent();
  settings.offset_codes = 100;
  const std::vector<std::int32_t> codes = convert(settings, 0, 0, {0.0, 500e-6});
  EXPECT_EQ(codes[0], -100);
  EXPECT_NEAR((codes[1] + settings.offset_codes) * settings.strain_per_code(), 500e-6,
              settings.strain_per_code());
}

TEST(FrontEnd, RefusesWhatCannotBe) {
  const auto refused = [](auto change) {
    FrontEndSettings settings;
    change(settings);
    EXPECT_THROW(check(settings), InputError);
  };
  refused([](FrontEndSettings& s) { s.bits = 11; });
  refused([](FrontEndSettings& s) { s.bits = 25; });
  refused([](FrontEndSettings& s) { s.range_microstrain = 0.0; });
  refused([](FrontEndSettings& s) { s.range_microstrain = std::nan(""); });
  refused([](FrontEndSettings& s) { s.noise_microstrain = -1.0; });
  refused([](FrontEndSettings& s) { s.hum_microstrain = std::nan(""); });
  refused([](FrontEndSettings& s) { s.offset_codes = 40000; });
  EXPECT_NO_THROW(check(FrontEndSettings{}));
}

TEST(Scenario, BenchFileIsTheBenchThatIsSimulated) {
  for (const Scenario& scenario : scenarios()) {
    const Bench read = parse_bench(bench_toml(scenario), scenario.name);
    EXPECT_EQ(read.kind, scenario.bench.kind) << scenario.name;
    ASSERT_EQ(read.gauges.size(), scenario.model.gauges.size());
    EXPECT_DOUBLE_EQ(read.input.length_m, scenario.model.input.length_m);
    EXPECT_DOUBLE_EQ(read.input.area_m2(), scenario.model.input.area_m2);
    EXPECT_DOUBLE_EQ(read.input.density_kg_m3, scenario.model.input.material.density_kg_m3);
    for (std::size_t i = 0; i < read.gauges.size(); ++i) {
      EXPECT_DOUBLE_EQ(read.gauges[i].position_m, scenario.model.gauges[i].position_m);
      EXPECT_EQ(read.gauges[i].unit, "V");
      EXPECT_DOUBLE_EQ(*read.gauges[i].strain_per_V, scenario.front_end.strain_per_V());
    }
    ASSERT_EQ(read.specimen.has_value(), scenario.model.specimen.has_value());
    if (read.specimen) {
      EXPECT_DOUBLE_EQ(read.specimen->length_m, scenario.model.specimen->length_m);
      EXPECT_DOUBLE_EQ(read.specimen->area_m2(), scenario.model.specimen->area_m2);
    }
  }
  EXPECT_THROW((void)find_scenario("nowhere"), InputError);
}

TEST(Scenario, IncidentPulseHasTheStrengthAndLengthOfThePaper) {
  for (const char* name : {"core", "cover", "core-6mm", "bars-together", "bar"}) {
    const Scenario scenario = find_scenario(name);
    const BenchHistory shot = run_bench(scenario.model, 1.0 / kStepsPerSecond, 3600);  // 450 us
    const std::vector<double>& strain = shot.gauge_strain[0];
    const double most = *std::max_element(strain.begin(), strain.end());
    EXPECT_NEAR(most, 1000e-6, 10e-6) << name;
    const auto above = std::count_if(strain.begin(), strain.end(),
                                     [most](double value) { return value > 0.5 * most; });
    // 170 us at the foot less one ramp of 40 us at half height; the bar hardly lengthens that.
    EXPECT_NEAR(static_cast<double>(above) / kStepsPerSecond, 130e-6, 5e-6) << name;
    EXPECT_DOUBLE_EQ(scenario.model.pulse.duration_s, 170e-6);
  }
}

TEST(Scenario, TruthIsOneRowPerSample) {
  const Scenario scenario = find_scenario("core");
  const BenchHistory shot = run_shot(scenario);
  std::ostringstream csv;
  write_truth(scenario, shot, csv);
  std::istringstream lines(csv.str());
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "time_s,stress_Pa,strain,strain_rate_per_s,force_front_N,force_back_N");
  std::vector<double> times;
  while (std::getline(lines, line)) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), 5);
    times.push_back(std::stod(line));
  }
  ASSERT_EQ(times.size(), 4000U);
  EXPECT_NEAR(times[1] - times[0], 1e-6, 1e-12);
  std::ostringstream none;
  const Scenario bar = find_scenario("bar");
  EXPECT_THROW(write_truth(bar, BenchHistory{}, none), InputError);
}

TEST(ScenarioSource, PlaysTheShotWhereItWasFired) {
  Scenario scenario = find_scenario("core");
  scenario.front_end = silent();
  const BenchHistory shot = run_shot(scenario);
  ScenarioSource source(scenario, shot);
  source.fire(10'000);
  std::vector<std::int32_t> codes(12'000);
  source.convert(0, 9'000, codes);
  const double step = scenario.front_end.strain_per_code();
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const double expected = i >= 1000 && i < 9000 ? shot.gauge_strain[0][(i - 1000) * 8] : 0.0;
    ASSERT_NEAR(codes[i] * step, expected, 0.501 * step) << i;
  }
  source.set_rate({250'000, 1});
  EXPECT_EQ(source.shot_samples(), 2000);
  source.fire(0);
  std::vector<std::int32_t> slow(2000);
  source.convert(1, 0, slow);
  for (std::size_t i = 0; i < slow.size(); ++i) {
    ASSERT_NEAR(slow[i] * step, shot.gauge_strain[1][i * 32], 0.501 * step) << i;
  }
}

TEST(ScenarioSource, MakesTwentyMillionSamplesASecond) {
#ifdef KOLSKY_SANITIZED
  GTEST_SKIP() << "a sanitizer's speed says nothing";
#endif
  const Scenario scenario = find_scenario("core");
  ScenarioSource source(scenario, run_shot(scenario));
  std::vector<std::int32_t> codes(1024);
  double best = 0.0;
  for (int attempt = 0; attempt < 5; ++attempt) {  // others may share the machine: the best of five
    const auto start = std::chrono::steady_clock::now();
    for (Tick tick = 0; tick < 1'000'000; tick += 1024) {
      source.convert(0, tick, codes);
      source.convert(1, tick, codes);
    }
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::max(best, 2e6 / took.count());
  }
  RecordProperty("samples per second", std::to_string(best));
  EXPECT_GT(best, 20e6);
}

Shot stored_shot() {
  Shot shot;
  shot.id = "stored";
  shot.rate = {1'000'000, 1};
  for (int c = 0; c < 2; ++c) {
    ChannelRecord channel;
    channel.gauge = "g" + std::to_string(c + 1);
    channel.unit = "V";
    channel.scale = 1e-4;
    for (int i = 0; i < 4000; ++i) {
      channel.codes.push_back(i < 400 ? 10 + i % 3 : (c + 1) * (i % 997) - 300);
    }
    shot.channels.push_back(channel);
  }
  return shot;
}

TEST(CaptureSource, PlaysEveryCode) {
  const Shot shot = stored_shot();
  CaptureSource source({shot}, 1);
  source.fire(5000);
  std::vector<std::int32_t> codes(4000);
  for (std::size_t channel = 0; channel < 2; ++channel) {
    source.convert(channel, 5000, codes);
    EXPECT_EQ(codes, shot.channels[channel].codes);
    std::vector<std::int32_t> before(1000);
    source.convert(channel, 4000, before);
    EXPECT_LT(*std::max_element(before.begin(), before.end()), 20);
    EXPECT_GT(*std::min_element(before.begin(), before.end()), 0);
  }
  const AdcSettings settings = source.settings();
  EXPECT_EQ(settings.channels[1].label, "g2");
  EXPECT_DOUBLE_EQ(settings.channels[1].scale_mV, 0.1);
  EXPECT_FALSE(settings.channels[1].strain_scale);
}

TEST(CaptureSource, PlaysCapturesInTurn) {
  Shot second = stored_shot();
  second.id = "second";
  for (auto& channel : second.channels) {
    for (auto& code : channel.codes) {
      code = -code;
    }
  }
  CaptureSource source({stored_shot(), second}, 1);
  for (const Tick tick : {0, 10'000, 20'000}) {
    source.fire(tick);
  }
  std::vector<std::int32_t> codes(4000);
  source.convert(0, 10'000, codes);
  EXPECT_EQ(codes, second.channels[0].codes);
  source.convert(0, 20'000, codes);
  EXPECT_EQ(codes, stored_shot().channels[0].codes);
}

TEST(CaptureSource, RefusesWhatDoesNotFitTogether) {
  EXPECT_THROW(CaptureSource({}, 1), InputError);
  Shot other = stored_shot();
  other.channels.pop_back();
  EXPECT_THROW(CaptureSource({stored_shot(), other}, 1), InputError);
  Shot faster = stored_shot();
  faster.rate = {2'000'000, 1};
  EXPECT_THROW(CaptureSource({stored_shot(), faster}, 1), InputError);
  Shot beyond = stored_shot();
  beyond.channels[0].codes[5] = 40'000;
  EXPECT_THROW(CaptureSource({beyond}, 1), InputError);
  Shot empty = stored_shot();
  empty.channels[0].codes.clear();
  EXPECT_THROW(CaptureSource({empty}, 1), InputError);
}

}  // namespace
}  // namespace kolsky

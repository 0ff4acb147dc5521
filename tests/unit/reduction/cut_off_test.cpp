// Pulses in closed form, as converters of known ends write them.
#include "processing/reduction/cut_off.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "processing/reduction/quality.hpp"
#include "processing/reduction/record_faults.hpp"

namespace kolsky {
namespace {

constexpr double kStep_V = 1e-4;

/// A half sine from sample 300 to 500 and one of the other sign, somewhat lower, from 700 to 900,
/// volts about an offset, with noise.
std::vector<double> two_pulses(double offset_V, double height_V) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 2.0 * kStep_V);
  std::vector<double> record(1200);
  const auto half_sine = [](double n, double first) {
    return n > first && n < first + 200.0 ? std::sin(std::numbers::pi * (n - first) / 200.0) : 0.0;
  };
  for (std::size_t n = 0; n < record.size(); ++n) {
    const auto at = static_cast<double>(n);
    record[n] =
        offset_V + height_V * (half_sine(at, 300.0) - 0.9 * half_sine(at, 700.0)) + noise(random);
  }
  return record;
}

/// As a converter from `low_V` to `high_V` has it.
std::vector<double> converted(std::vector<double> record, double low_V, double high_V) {
  for (double& value : record) {
    value = kStep_V * std::round(std::clamp(value, low_V, high_V) / kStep_V);
  }
  return record;
}

TEST(CutOff, IsNotARecordWithinTheConvertersRange) {
  EXPECT_FALSE(cut_off(converted(two_pulses(0.0, 0.2), -1.0, 1.0)));
  EXPECT_FALSE(cut_off(converted(two_pulses(-0.07, 0.2), -1.0, 1.0)));
  EXPECT_FALSE(cut_off({}));
}

// From -0.07 V the pulse goes to 0.11 V and the other one to -0.25 V, which is the larger reading.
TEST(CutOff, IsSeenAtTheSmallerOfTwoReadings) {
  const auto top = cut_off(converted(two_pulses(-0.07, 0.2), -1.0, 0.11));
  ASSERT_TRUE(top);
  EXPECT_NEAR(static_cast<double>(top->first), 371.0, 3.0);
  EXPECT_NEAR(static_cast<double>(top->count), 58.0, 6.0);
}

// Without an offset, the lower of two pulses.
TEST(CutOff, IsSeenAtTheLowerOfTwoPulses) {
  const auto top = cut_off(converted(two_pulses(0.0, 0.2), -0.12, 1.0));
  ASSERT_TRUE(top);
  EXPECT_GT(top->first, 700U);
  EXPECT_LT(top->first + top->count, 900U);
}

TEST(CutOff, IsSeenAtBothEndsAtOnce) {
  const auto top = cut_off(converted(two_pulses(0.0, 0.2), -0.12, 0.12));
  ASSERT_TRUE(top);
  EXPECT_GT(top->count, 40U);
}

/// A pulse that pushes only: its record is least where it is quiet, at one code for long.
std::vector<double> quiet_at_one_code() {
  std::vector<double> record(1200, 0.0);
  for (std::size_t n = 300; n < 500; ++n) {
    const double phase = std::numbers::pi * static_cast<double>(n - 300) / 200.0;
    record[n] = kStep_V * std::round(0.2 * std::sin(phase) / kStep_V);
  }
  return record;
}

TEST(CutOff, IsNotAQuietRecordAtOneCode) {
  EXPECT_FALSE(cut_off(quiet_at_one_code()));
}

/// A shot of one gauge as a table has it: no ends of the converter are filed.
Shot of_a_table(const std::vector<double>& record) {
  Shot shot;
  shot.bench.gauges.emplace_back().name = "g1";
  shot.rate = {1'000'000, 1};
  ChannelRecord& channel = shot.channels.emplace_back();
  channel.gauge = "g1";
  channel.scale = kStep_V;
  channel.code_min = std::numeric_limits<std::int32_t>::min();
  channel.code_max = std::numeric_limits<std::int32_t>::max();
  for (const double value : record) {
    channel.codes.push_back(static_cast<std::int32_t>(std::lround(value / kStep_V)));
  }
  return shot;
}

TEST(FlatTop, OfATableIsWhereItsRecordIsCutOff) {
  const Check quiet = clipping(longest_flat_top(of_a_table(quiet_at_one_code())));
  EXPECT_EQ(quiet.verdict, Verdict::pass);
  EXPECT_NE(quiet.text.find("a table does not say"), std::string::npos) << quiet.text;
  const std::vector<double> cut = converted(two_pulses(-0.07, 0.2), -1.0, 0.11);
  const Check clipped = clipping(longest_flat_top(of_a_table(cut)));
  EXPECT_EQ(clipped.verdict, Verdict::warn);
  EXPECT_EQ(clipped.value, static_cast<double>(cut_off(cut)->count));
  EXPECT_EQ(clipped.text.find("g1 stays at"), 0U) << clipped.text;
}

TEST(SpoiledBecause, NamesTheGaugeAndTheSample) {
  const std::vector<double> record = converted(two_pulses(-0.07, 0.2), -1.0, 0.11);
  const auto top = cut_off(record);
  ASSERT_TRUE(top);
  EXPECT_EQ(spoiled_because(of_a_table(record)),
            "gauge g1 stays at its extreme for " + std::to_string(top->count) + " samples from " +
                std::to_string(top->first) + " on: it was cut off there");
}

}  // namespace
}  // namespace kolsky

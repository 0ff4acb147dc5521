#include "processing/reduction/pulse.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "processing/reduction/first_pulse.hpp"

namespace kolsky {
namespace {

/// a (t - t0)^p up to `length` samples after t0, then level.
std::vector<double> power_rise(double t0, double p, double length, std::size_t samples) {
  std::vector<double> record(samples);
  for (std::size_t n = 0; n < samples; ++n) {
    const double t = std::min(std::max(0.0, static_cast<double>(n) - t0), length);
    record[n] = std::pow(t / length, p);
  }
  return record;
}

TEST(FootOf, IsExactForPowerLawsOfAnyKind) {
  for (const double p : {1.0, 1.5, 2.0, 3.0}) {
    const auto record = power_rise(100.3, p, 400.0, 1000);
    const auto half = static_cast<std::size_t>(100.3 + 400.0 * std::pow(0.5, 1.0 / p));
    EXPECT_NEAR(foot_of(record, half, 1.0, 0.0).index, 100.3, 0.3) << p;
  }
}

TEST(FootOf, SigmaGrowsWithTheNoise) {
  const auto record = power_rise(100.3, 1.0, 40.0, 1000);
  const Foot quiet = foot_of(record, 120, 1.0, 0.001);
  const Foot loud = foot_of(record, 120, 1.0, 0.01);
  EXPECT_NEAR(loud.sigma / quiet.sigma, 10.0, 1e-6);
}

TEST(FindFirstPulse, TakesTheFirstAndNotTheLargest) {
  std::vector<double> record(2000, 0.5);
  for (std::size_t n = 400; n < 500; ++n) {
    record[n] += -0.4;
  }
  for (std::size_t n = 1000; n < 1200; ++n) {
    record[n] += 1.0;
  }
  const auto rise = find_first_pulse(record, 5, 200);
  ASSERT_TRUE(rise);
  EXPECT_EQ(rise->index, 399U);
  EXPECT_EQ(rise->sense, -1.0);
}

TEST(FindFirstPulse, ASpikeIsNotAPulse) {
  std::vector<double> record(2000, 0.0);
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 0.001);
  for (double& value : record) {
    value = noise(random);
  }
  record[300] = 1.0;
  record[301] = 1.0;
  EXPECT_FALSE(find_first_pulse(record, 5, 200));
  for (std::size_t n = 900; n < 1000; ++n) {
    record[n] += 0.8;
  }
  const auto rise = find_first_pulse(record, 5, 200);
  ASSERT_TRUE(rise);
  EXPECT_EQ(rise->index, 899U);
}

/// A step after so many samples, of that share of the noise.
std::vector<double> early_step(std::size_t quiet, double noise_rms) {
  std::vector<double> record(1000);
  std::mt19937 random(2);
  std::normal_distribution<double> noise(0.0, noise_rms);
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] = noise(random) + (n >= quiet && n < quiet + 10 ? 1.0 : 0.0);
  }
  return record;
}

// Slowly sampled records have little before their pulse.
TEST(FindFirstPulse, FindsAPulseThatComesWithinTheFirstLook) {
  for (const std::size_t quiet : {10U, 18U, 24U, 31U}) {
    const auto rise = find_first_pulse(early_step(quiet, 0.01), 3, 10);
    ASSERT_TRUE(rise) << quiet;
    EXPECT_EQ(rise->index, quiet - 1);
    EXPECT_FALSE(find_first_pulse(early_step(quiet, 0.5), 3, 10)) << "in the noise";
  }
  EXPECT_FALSE(find_first_pulse(early_step(4, 0.01), 3, 10)) << "nothing is known of the noise";
}

TEST(FindFirstPulse, NoiseAloneIsNoPulseHoweverLittleOfItIsLookedAt) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int repeat = 0; repeat < 300; ++repeat) {
    std::vector<double> record(1000);
    for (double& value : record) {
      value = noise(random);
    }
    EXPECT_FALSE(find_first_pulse(record, 3, 100)) << repeat;
  }
}

TEST(FindFirstPulse, NothingInAConstantOrAnEmptyRecord) {
  EXPECT_FALSE(find_first_pulse(std::vector<double>(1000, 3.0), 5, 100));
  EXPECT_FALSE(find_first_pulse({}, 5, 100));
}

/// A ramp that takes `rise` samples from `foot` on, then a plateau.
std::vector<double> ramp(double foot, double rise, double height, double offset) {
  std::vector<double> record(3000, offset);
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] += height * std::clamp((static_cast<double>(n) - foot) / rise, 0.0, 1.0);
  }
  return record;
}

TEST(FirstPulse, IsMeasuredFromItsFootToItsHeight) {
  const auto pulse = first_pulse(ramp(500.25, 40.0, -2e-3, 0.7), 1e6);
  ASSERT_TRUE(pulse);
  EXPECT_NEAR(pulse->foot, 500.25, 0.05);
  EXPECT_NEAR(pulse->half, 520.25, 1e-6);
  EXPECT_EQ(pulse->rise, 520U);
  EXPECT_NEAR(pulse->height, 2e-3, 1e-12);
  EXPECT_EQ(pulse->quiet, 490U) << "10 us before the foot";
}

TEST(FirstPulse, ReachesAndClearsInTimeNotInSamples) {
  auto record = ramp(500.0, 40.0, 1e-3, 0.0);
  const auto later = ramp(1300.0, 40.0, 5e-3, 0.0);
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] += later[n];
  }
  EXPECT_NEAR(first_pulse(record, 1e6)->height, 1e-3, 1e-12) << "the second is 800 us behind";
  const auto twice_as_fast = first_pulse(record, 2e6);
  EXPECT_NEAR(twice_as_fast->height, 6e-3, 1e-12) << "and 400 us at 2 MHz";
  EXPECT_LT(first_pulse(ramp(15.0, 40.0, 1e-3, 0.0), 1e6)->quiet, kFewestQuiet);
  EXPECT_FALSE(first_pulse(std::vector<double>(1000, 3.0), 1e6));
}

TEST(QuietBefore, AnOffsetDoesNotCostTheNoiseItsDigits) {
  std::vector<double> record(1000);
  for (std::size_t n = 0; n < record.size(); ++n) {
    record[n] = 1e6 + (n % 2 == 0 ? 1e-4 : -1e-4);
  }
  EXPECT_NEAR(quiet_before(record, 1000).noise_rms, 1e-4, 1e-8);
}

}  // namespace
}  // namespace kolsky

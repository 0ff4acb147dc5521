#include "processing/reduction/pulse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

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

TEST(FindFirstPulse, NothingInAConstantOrAnEmptyRecord) {
  EXPECT_FALSE(find_first_pulse(std::vector<double>(1000, 3.0), 5, 100));
  EXPECT_FALSE(find_first_pulse({}, 5, 100));
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

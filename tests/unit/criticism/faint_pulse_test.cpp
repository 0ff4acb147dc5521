#include "processing/criticism/records/faint_pulse.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace kolsky {
namespace {

constexpr std::size_t kQuiet = 240;
constexpr std::size_t kSamples = 2000;

/// Unit noise that forgets itself by this share from sample to sample.
std::vector<double> noise(std::uint64_t seed, double keep) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> record(kSamples);
  double value = normal(random);
  for (double& sample : record) {
    sample = value;
    value = keep * value + std::sqrt(1.0 - keep * keep) * normal(random);
  }
  return record;
}

void add_half_sine(std::vector<double>& record, double height, std::size_t samples) {
  for (std::size_t n = 0; n < samples; ++n) {
    record[kQuiet + 100 + n] +=
        height * std::sin(std::numbers::pi * static_cast<double>(n) / static_cast<double>(samples));
  }
}

TEST(FaintPulse, NoiseHasNone) {
  for (const double keep : {0.0, 0.5, 0.9}) {
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
      found += stands_out_on_average(noise(seed, keep), kQuiet) ? 1 : 0;
    }
    EXPECT_LE(found, 3) << keep;
  }
}

// Three times the noise, a tenth of a millisecond long at a megahertz.
TEST(FaintPulse, ThatIsHardlyMoreThanTheNoiseIsFound) {
  int found = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    std::vector<double> record = noise(seed, 0.0);
    add_half_sine(record, 3.0, 100);
    found += stands_out_on_average(record, kQuiet) ? 1 : 0;
  }
  EXPECT_GE(found, 95);
}

TEST(FaintPulse, TooFewQuietSamplesTellNothing) {
  std::vector<double> record = noise(1, 0.0);
  add_half_sine(record, 100.0, 100);
  EXPECT_FALSE(stands_out_on_average(record, 7));
  EXPECT_TRUE(stands_out_on_average(record, 8));
}

}  // namespace
}  // namespace kolsky

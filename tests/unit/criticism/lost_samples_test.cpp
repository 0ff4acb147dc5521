#include "processing/criticism/records/lost_samples.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace kolsky {
namespace {

constexpr std::size_t kQuiet = 300;
constexpr double kHeight = 1000.0;

/// A pulse of `length` samples with edges of `edge`, in codes.
std::vector<double> pulse(std::size_t length, std::size_t edge, double noise_rms, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<double> codes(2000);
  for (std::size_t n = 0; n < codes.size(); ++n) {
    const double in = static_cast<double>(n) - static_cast<double>(kQuiet);
    const double left = std::min(in, static_cast<double>(length) - in) / static_cast<double>(edge);
    const double rise = std::clamp(left, 0.0, 1.0);
    codes[n] = std::round(kHeight * 0.5 * (1.0 - std::cos(std::numbers::pi * rise)) +
                          noise_rms * noise(random));
  }
  return codes;
}

TEST(LostSamples, AreFoundWhereARecordJumpsAwayAndBack) {
  for (const std::size_t count : {1U, 2U, 20U}) {
    for (const double reading : {0.0, kHeight + 500.0}) {
      std::vector<double> codes = pulse(200, 25, 4.0, 1);
      std::fill_n(codes.begin() + 400, count, reading);
      const auto lost = lost_samples(codes, kQuiet);
      ASSERT_TRUE(lost) << count;
      EXPECT_EQ(lost->first, 400U);
      EXPECT_EQ(lost->count, count);
    }
  }
}

// Measured records have a spike now and then: fourteen steps of a converter that noise hardly moves
// are, in 40000 samples, a twentieth of the noise.
TEST(LostSamples, AreNotWhatIsLostInTheNoise) {
  std::vector<double> codes = pulse(200, 25, 0.3, 1);
  const std::vector<double> quiet(codes.begin(), codes.begin() + 256);
  while (codes.size() < 40000) {
    codes.insert(codes.end(), quiet.begin(), quiet.end());
  }
  codes[1000] = 14.0;
  EXPECT_FALSE(lost_samples(codes, kQuiet));
  codes[1000] = 60.0;
  EXPECT_TRUE(lost_samples(codes, kQuiet));
}

// Fronts of a sample, pulses of a few, converters of few steps, and noise.
TEST(LostSamples, AreNotWhatStrainDoes) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    EXPECT_FALSE(lost_samples(pulse(200, 25, 4.0, seed), kQuiet)) << seed;
    EXPECT_FALSE(lost_samples(pulse(200, 25, 0.3, seed), kQuiet)) << "few steps, " << seed;
    EXPECT_FALSE(lost_samples(pulse(200, 25, 100.0, seed), kQuiet)) << "much noise, " << seed;
  }
  EXPECT_FALSE(lost_samples(pulse(200, 1, 0.0, 1), kQuiet)) << "edges of a sample";
  EXPECT_FALSE(lost_samples(pulse(8, 4, 0.0, 1), kQuiet)) << "a short pulse";
  std::vector<double> steep = pulse(200, 1, 0.0, 1);
  for (std::size_t n = 800; n < steep.size(); ++n) {
    steep[n] = static_cast<double>(n % 50);
  }
  EXPECT_FALSE(lost_samples(steep, kQuiet)) << "a steep pulse before what has small steps";
}

}  // namespace
}  // namespace kolsky

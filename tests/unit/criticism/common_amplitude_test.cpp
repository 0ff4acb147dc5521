#include "processing/criticism/search/common_amplitude.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace kolsky {
namespace {

/// What records say that show the sine part well and the cosine part hardly.
std::vector<QuadratureParts> shots_of(double amplitude, double cosine_sd, double sine_sd,
                                      std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
  std::vector<QuadratureParts> shots(8);
  for (QuadratureParts& shot : shots) {
    const double at = phase(random);
    const double cosine = amplitude * std::cos(at) + cosine_sd * normal(random);
    const double sine = amplitude * std::sin(at) + sine_sd * normal(random);
    shot.information.diagonal() << std::pow(cosine_sd, -2.0), std::pow(sine_sd, -2.0);
    shot.pull = shot.information * Eigen::Vector2d(cosine, sine);
  }
  return shots;
}

TEST(CommonAmplitude, IsFoundThoughHalfOfItIsHardlySeen) {
  std::mt19937_64 random(11);
  constexpr double kAmplitude = 40.0;
  constexpr int kRepeats = 300;
  double mean = 0.0;
  int inside = 0;
  for (int n = 0; n < kRepeats; ++n) {
    const Amplitude found = common_amplitude(shots_of(kAmplitude, 60.0, 4.0, random));
    mean += found.value / kRepeats;
    inside += std::abs(found.value - kAmplitude) < 1.96 * found.sd ? 1 : 0;
  }
  EXPECT_NEAR(mean, kAmplitude, 0.04 * kAmplitude);
  EXPECT_GT(inside, 0.91 * kRepeats);
  EXPECT_LT(inside, 0.985 * kRepeats);
}

TEST(CommonAmplitude, OfNoiseIsNoMoreThanItsDeviations) {
  std::mt19937_64 random(12);
  for (int n = 0; n < 50; ++n) {
    const Amplitude found = common_amplitude(shots_of(0.0, 4.0, 4.0, random));
    EXPECT_LT(found.value, 4.0 * found.sd);
    EXPECT_LT(found.value, 8.0);
  }
}

TEST(CommonAmplitude, OfNothingSeenIsNone) {
  EXPECT_EQ(common_amplitude(std::vector<QuadratureParts>(3)).value, 0.0);
}

}  // namespace
}  // namespace kolsky

#include "processing/identification/noise_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace kolsky {
namespace {

/// Stretches of first-order noise of unit variance on white noise.
std::vector<std::vector<double>> stretches(std::size_t count, std::size_t samples, double white_sd,
                                           double keep) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<std::vector<double>> list;
  for (std::size_t i = 0; i < count; ++i) {
    double slow = normal(random);
    auto& stretch = list.emplace_back();
    for (std::size_t n = 0; n < samples; ++n) {
      slow = keep * slow + std::sqrt(1.0 - keep * keep) * normal(random);
      stretch.push_back((keep > 0.0 ? slow : 0.0) + white_sd * normal(random));
    }
  }
  return list;
}

NoiseSpectrum spectrum_of(const std::vector<std::vector<double>>& list) {
  return NoiseSpectrum({list.begin(), list.end()});
}

TEST(NoiseSpectrum, WhiteNoiseIsWhite) {
  const NoiseSpectrum noise = spectrum_of(stretches(10, 400, 3.0, 0.0));
  EXPECT_EQ(noise.order(), 0U);
  for (const double f : {0.0, 0.01, 0.2, 0.5}) {
    EXPECT_NEAR(noise.power(f), 9.0, 0.7);
  }
  EXPECT_NEAR(noise.variance_of_mean(400), 9.0 / 400.0, 0.002);
}

TEST(NoiseSpectrum, SlowNoiseThatHardlyShowsInAStretchIsFound) {
  constexpr double kKeep = 0.99;
  const NoiseSpectrum noise = spectrum_of(stretches(20, 400, 0.5, kKeep));
  for (const double f : {0.0, 0.002, 0.01, 0.05}) {
    const double turn = 2.0 * std::acos(-1.0) * f;
    const double truth =
        0.25 + (1.0 - kKeep * kKeep) / (1.0 - 2.0 * kKeep * std::cos(turn) + kKeep * kKeep);
    // Twenty stretches of four correlation times each know little of what is slower.
    EXPECT_NEAR(noise.power(f) / truth, 1.0, f < 0.001 ? 0.7 : 0.35) << f;
  }
  // The mean of 400 samples: sum of (1 - l/n) keep^l over all lags, over n.
  double sum = 1.0;
  for (int lag = 1; lag < 400; ++lag) {
    sum += 2.0 * (1.0 - lag / 400.0) * std::pow(kKeep, lag);
  }
  EXPECT_NEAR(noise.variance_of_mean(400) / ((sum + 0.25) / 400.0), 1.0, 0.5);
}

// Where the likelihood is highest, any factor on all weights together loses: data over model are 1
// on average over the bins, with the data's transform and the model's power as anyone has them.
TEST(NoiseSpectrum, WeightsAreWhereTheLikelihoodIsHighest) {
  constexpr std::size_t kSamples = 240;
  for (const double keep : {0.0, 0.9, 0.99, 0.999}) {
    const auto list = stretches(3, kSamples, 0.5, keep);
    const NoiseSpectrum noise = spectrum_of(list);
    double sum = 0.0;
    for (std::size_t k = 1; k < kSamples / 2; ++k) {
      const double cycles = static_cast<double>(k) / kSamples;
      double power = 0.0;
      for (const auto& stretch : list) {
        std::complex<double> bin = 0.0;
        for (std::size_t n = 0; n < kSamples; ++n) {
          const double turn = 2.0 * std::numbers::pi * static_cast<double>(k * n % kSamples);
          bin += stretch[n] * std::polar(1.0, -turn / kSamples);
        }
        power += std::norm(bin) / kSamples / static_cast<double>(list.size());
      }
      sum += power / noise.power_within(cycles, kSamples);
    }
    EXPECT_NEAR(sum / (kSamples / 2 - 1), 1.0, 1e-4) << keep;
  }
}

TEST(NoiseSpectrum, ShapedNoiseIsFollowed) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal(0.0, 1.0);
  std::vector<std::vector<double>> list(10);
  for (auto& stretch : list) {
    double before = 0.0;
    for (int n = 0; n < 400; ++n) {
      before = -0.8 * before + normal(random);
      stretch.push_back(before);
    }
  }
  const NoiseSpectrum noise = spectrum_of(list);
  EXPECT_NEAR(noise.power(0.5) / 25.0, 1.0, 0.2);
  EXPECT_NEAR(noise.power(0.0) / (1.0 / 3.24), 1.0, 0.2);
}

TEST(NoiseSpectrum, NoNoiseIsNoPower) {
  const std::vector<double> quiet(100, 0.0);
  EXPECT_EQ(NoiseSpectrum({quiet}).power(0.1), 0.0);
  EXPECT_EQ(NoiseSpectrum({}).power(0.1), 0.0);
}

}  // namespace
}  // namespace kolsky

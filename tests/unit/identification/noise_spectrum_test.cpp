#include "processing/identification/noise_spectrum.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <span>
#include <vector>

namespace kolsky {
namespace {

/// Stretches of first-order noise of unit variance on white noise.
std::vector<std::vector<double>> stretches(std::size_t count, std::size_t samples, double white_sd,
                                           double keep, unsigned seed = 5) {
  std::mt19937_64 random(seed);
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

/// Power of first-order noise of unit variance on white noise.
double power_of(double white_sd, double keep, double cycles) {
  const double turn = 2.0 * std::numbers::pi * cycles;
  return white_sd * white_sd +
         (1.0 - keep * keep) / (1.0 - 2.0 * keep * std::cos(turn) + keep * keep);
}

/// Of 20 bins of three long stretches, as they scatter.
NoiseSpectrum::Seen seen_of(double white_sd, double keep, double level, unsigned seed) {
  NoiseSpectrum::Seen seen;
  seen.samples = 4000.0;
  seen.stretches = 3.0;
  std::mt19937_64 random(seed);
  std::gamma_distribution<double> scatter(seen.stretches, 1.0 / seen.stretches);
  for (int k = 1; k <= 20; ++k) {
    seen.cycles.push_back(k / seen.samples);
    seen.power.push_back(level * power_of(white_sd, keep, seen.cycles.back()) * scatter(random));
  }
  return seen;
}

// Noise that keeps itself for a thousand samples: over 400 that is next to a constant.
TEST(NoiseSpectrum, LongerStretchesShowWhatQuietOnesAreTooShortFor) {
  constexpr double kKeep = 0.999;
  constexpr unsigned kRepeats = 20;
  const double truth = power_of(1.0, kKeep, 0.001);
  double by_quiet = 0.0;
  double by_both = 0.0;
  for (unsigned seed = 0; seed < kRepeats; ++seed) {
    const auto quiet = stretches(3, 400, 1.0, kKeep, seed);
    by_quiet += std::pow(std::log(spectrum_of(quiet).power(0.001) / truth), 2) / kRepeats;
    const NoiseSpectrum both({quiet.begin(), quiet.end()}, seen_of(1.0, kKeep, 1.0, seed));
    by_both += std::pow(std::log(both.power(0.001) / truth), 2) / kRepeats;
  }
  EXPECT_GT(std::sqrt(by_quiet), 2.0 * std::sqrt(by_both));
}

TEST(NoiseSpectrum, GaugesThatAreAlikeShareAShapeEachAtItsLevel) {
  constexpr double kKeep = 0.99;
  std::vector<std::vector<std::vector<double>>> records;
  std::vector<std::vector<std::span<const double>>> quiet;
  std::vector<NoiseSpectrum::Seen> seen;
  const std::vector<double> levels{1.0, 4.0, 0.25};
  const auto all = stretches(9, 400, 1.0, kKeep);
  for (std::size_t j = 0; j < levels.size(); ++j) {
    auto& own = records.emplace_back(all.begin() + static_cast<std::ptrdiff_t>(3 * j),
                                     all.begin() + static_cast<std::ptrdiff_t>(3 * j + 3));
    for (auto& stretch : own) {
      for (double& value : stretch) {
        value *= std::sqrt(levels[j]);
      }
    }
    quiet.emplace_back(own.begin(), own.end());
    seen.push_back(seen_of(1.0, kKeep, levels[j], 10 + static_cast<unsigned>(j)));
  }
  const auto spectra = NoiseSpectrum::of_gauges(quiet, seen);
  for (std::size_t j = 0; j < levels.size(); ++j) {
    EXPECT_NEAR(spectra[j].power(0.5) / levels[j], power_of(1.0, kKeep, 0.5), 0.2);
    // One shape: the same share is slow.
    EXPECT_NEAR(spectra[j].power(0.001) / spectra[j].power(0.5),
                spectra[0].power(0.001) / spectra[0].power(0.5), 1e-9);
  }
}

TEST(NoiseSpectrum, AGaugeOfItsOwnKindKeepsItsSpectrum) {
  const auto slow = stretches(4, 400, 0.3, 0.99);
  const auto white = stretches(4, 400, 1.0, 0.0);
  const auto spectra =
      NoiseSpectrum::of_gauges({{slow.begin(), slow.end()}, {white.begin(), white.end()}},
                               std::vector<NoiseSpectrum::Seen>(2));
  EXPECT_EQ(spectra[1].order(), 0U);
  EXPECT_NEAR(spectra[1].power(0.01), 1.0, 0.2);
  EXPECT_GT(spectra[0].power(0.001), 20.0);
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

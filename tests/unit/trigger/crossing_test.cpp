#include "processing/trigger/crossing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include "processing/trigger/baseline.hpp"
#include "tests/unit/trigger/signals.hpp"

namespace kolsky {
namespace {

constexpr double kLevel = 8.0;  // the noise is one

TEST(Crossing, OfACubicEdgeIsExact) {
  // y = 8 at x = 20.3 by construction, steep enough for the least window.
  std::vector<double> edge(40);
  for (std::size_t i = 0; i < edge.size(); ++i) {
    const double x = static_cast<double>(i) - 20.3;
    edge[i] = kLevel + 5.0 * x + 0.3 * x * x + 0.2 * x * x * x;
  }
  const auto crossing = fit_crossing(edge, 20, kLevel, 10);
  ASSERT_TRUE(crossing);
  EXPECT_NEAR(crossing->position, 20.3, 1e-9);
}

TEST(Crossing, OfFourSamplesHasTheNoiseOfCubicInterpolation) {
  // Halfway between two samples Lagrange's weights are -1/16, 9/16, 9/16, -1/16.
  std::vector<double> edge(40);
  for (std::size_t i = 0; i < edge.size(); ++i)
    edge[i] = 10.0 * (static_cast<double>(i) - 20.5) + kLevel;
  const auto crossing = fit_crossing(edge, 20, kLevel, 10);
  ASSERT_TRUE(crossing);
  EXPECT_EQ(crossing->points, 4U);
  EXPECT_NEAR(crossing->noise_share, (1.0 + 81.0 + 81.0 + 1.0) / 256.0, 1e-9);
  EXPECT_NEAR(crossing->slope, 10.0, 1e-9);
}

TEST(Crossing, IsNotFoundWhereNothingRises) {
  EXPECT_FALSE(fit_crossing(std::vector<double>(100, 0.0), 50, kLevel, 20));
  EXPECT_FALSE(fit_crossing(std::vector<double>(100, 20.0), 50, kLevel, 20));
  std::vector<double> falling(100);
  for (std::size_t i = 0; i < falling.size(); ++i) falling[i] = 50.0 - static_cast<double>(i);
  EXPECT_FALSE(fit_crossing(falling, 42, kLevel, 20));
}

TEST(Crossing, BetweenTwoSamplesOfAStepIsUncertainByTheStep) {
  std::vector<double> step(100, 0.0);
  std::fill(step.begin() + 50, step.end(), 1000.0);
  const auto crossing = fit_crossing(step, 49, kLevel, 10);
  ASSERT_TRUE(crossing);
  EXPECT_GE(crossing->position, 49.0);
  EXPECT_LE(crossing->position, 50.0);
  EXPECT_NEAR(std::sqrt(crossing->unresolved_variance), 1.0 / std::sqrt(12.0), 0.01);
}

struct Scatter {
  double bias = 0.0;
  double deviation = 0.0;
  double stated = 0.0;
};

Scatter repeat(const std::function<double(double)>& edge, double truth, std::size_t reach) {
  constexpr int kRepeats = 2000;
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise;
  double sum = 0.0, square = 0.0, stated = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const double foot = 100.0 + 0.01 * (repeat % 100);
    std::vector<double> samples(static_cast<std::size_t>(foot + truth) + 3 * reach);
    for (std::size_t i = 0; i < samples.size(); ++i) {
      samples[i] = noise(random) + edge(static_cast<double>(i) - foot);
    }
    const auto crossing =
        fit_crossing(samples, static_cast<std::size_t>(foot + truth), kLevel, reach);
    if (!crossing) {
      ADD_FAILURE() << "no crossing";
      return {};
    }
    const double error = crossing->position - foot - truth;
    sum += error;
    square += error * error;
    stated +=
        crossing->noise_share / (crossing->slope * crossing->slope) + crossing->unresolved_variance;
  }
  const double bias = sum / kRepeats;
  return {bias, std::sqrt(square / kRepeats - bias * bias), std::sqrt(stated / kRepeats)};
}

void expect_honest(const Scatter& scatter) {
  EXPECT_NEAR(scatter.deviation / scatter.stated, 1.0, 0.12);
  EXPECT_LT(std::abs(scatter.bias), 0.2 * scatter.stated);
}

TEST(Crossing, OfNoisyRampsScattersByItsStatedSigma) {
  for (const double slope : {0.2, 0.5, 1.0, 2.0, 5.0}) {
    SCOPED_TRACE(slope);
    expect_honest(repeat([&](double t) { return std::max(0.0, slope * t); }, kLevel / slope,
                         static_cast<std::size_t>(4.0 / slope) + 4));
  }
}

TEST(Crossing, OfNoisyPulsesScattersByItsStatedSigma) {
  for (const double peak : {20.0, 60.0, 150.0, 500.0}) {
    for (const double rise : {10.0, 30.0, 60.0}) {
      SCOPED_TRACE(testing::Message() << peak << " sigma in " << rise);
      const signals::Pulse pulse{peak, rise, 4 * rise};
      // Within one sample of the foot the edge has a corner that no smooth curve follows.
      if (pulse.reaches(kLevel) < 1.0) continue;
      const auto reach = static_cast<std::size_t>(pulse.reaches(8.0) - pulse.reaches(4.0)) + 4;
      expect_honest(repeat([&](double t) { return pulse.at(t); }, pulse.reaches(kLevel), reach));
    }
  }
}

std::vector<double> first_order_noise(double memory, std::size_t samples, std::uint64_t seed) {
  signals::Source source({.noise_codes = 1.0, .memory = memory}, seed);
  std::vector<double> noise(samples);
  for (double& sample : noise) sample = source.next();
  return noise;
}

// Of x[i+1] = r x[i] + ..., variance one: m Var(mean of m) = 1 + 2 sum over lags (1 - k/m) r^k.
double block_noise_of(double memory, int block) {
  double sum = 1.0;
  for (int lag = 1; lag < block; ++lag) {
    sum += 2.0 * (1.0 - static_cast<double>(lag) / block) * std::pow(memory, lag);
  }
  return sum;
}

TEST(BlockNoise, IsThatOfFirstOrderNoiseWhateverTheBlock) {
  for (const double memory : {0.0, 0.6, 0.9}) {
    for (const int block : {1, 4, 16}) {
      SCOPED_TRACE(testing::Message() << memory << ", " << block);
      double mean = 0.0;
      for (int repeat = 0; repeat < 40; ++repeat) {
        auto noise = first_order_noise(memory, 4096, static_cast<std::uint64_t>(repeat));
        mean += block_noise_variance(noise, static_cast<std::size_t>(block), 1e3) / 40.0;
      }
      EXPECT_NEAR(mean / block_noise_of(memory, block), 1.0, 0.06);
    }
  }
}

TEST(BlockNoise, IgnoresALineAndCutsSpikes) {
  auto noise = first_order_noise(0.0, 4096, 5);
  for (std::size_t i = 0; i < noise.size(); ++i) noise[i] += 0.1 * static_cast<double>(i);
  noise[700] += 1000.0;
  noise[3000] -= 1000.0;
  EXPECT_NEAR(block_noise_variance(noise, 1, 4.0), 1.0, 0.1);
}

TEST(QuietEstimate, FindsLineAndNoiseOfAShortStretch) {
  double line = 0.0, slope = 0.0, noise = 0.0, error = 0.0, stated = 0.0;
  constexpr int kRepeats = 2000;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    auto stretch = first_order_noise(0.0, 256, static_cast<std::uint64_t>(repeat));
    for (std::size_t i = 0; i < stretch.size(); ++i)
      stretch[i] += 30.0 + 0.05 * static_cast<double>(i);
    const QuietEstimate quiet = estimate_quiet(stretch);
    line += quiet.line.value_codes / kRepeats;
    slope += quiet.line.slope_codes / kRepeats;
    noise += quiet.noise_variance / kRepeats;
    const double ahead = quiet.line.value_codes + 128.0 * quiet.line.slope_codes;
    error += std::pow(ahead - (30.0 + 0.05 * (256.0 + 128.0)), 2) / kRepeats;
    stated += quiet.baseline_variance / kRepeats;
  }
  EXPECT_NEAR(line, 30.0 + 0.05 * 256.0, 0.02);
  EXPECT_NEAR(slope, 0.05, 1e-4);
  EXPECT_NEAR(noise, 1.0, 0.03);
  EXPECT_NEAR(error / stated, 1.0, 0.15);
}

TEST(QuietEstimate, HardlyMindsASpike) {
  for (const std::size_t at : {0UL, 100UL, 255UL}) {
    auto stretch = first_order_noise(0.0, 256, 9);
    const QuietEstimate clean = estimate_quiet(stretch);
    stretch[at] += 1000.0;
    stretch[at > 0 ? at - 1 : 1] += 700.0;
    const QuietEstimate spiked = estimate_quiet(stretch);
    EXPECT_NEAR(spiked.line.value_codes, clean.line.value_codes, 0.5);
    EXPECT_NEAR(spiked.noise_variance, clean.noise_variance, 0.4);
  }
}

TEST(BaselineTracker, PredictsALineExactly) {
  BaselineTracker tracker({256, 20000, 400});
  const auto line = [](double sample) { return 10.0 + 0.01 * sample; };
  tracker.start({{line(0.0), 0.01}, 1.0, 0.1}, 256);
  constexpr double kCell = BaselineTracker::kCell;
  for (int cell = 0; cell < 50; ++cell) {
    const BaselineLine next = tracker.next_cell();
    EXPECT_NEAR(next.value_codes, line(cell * kCell), 1e-9);
    EXPECT_NEAR(next.slope_codes, 0.01, 1e-12);
    if (cell % 7 == 3) {
      tracker.skip();
    } else {
      tracker.take(line((cell + 0.5) * kCell - 0.5), 0.0);
    }
  }
}

TEST(BaselineTracker, HoldsTheFootOfAPulseBackForTheGuardTime) {
  constexpr std::size_t kGuardCells = 3;
  BaselineTracker tracker({256, 20000, kGuardCells * BaselineTracker::kCell});
  tracker.start({{0.0, 0.0}, 1.0, 0.1}, 256);
  for (int cell = 0; cell < 20; ++cell) tracker.take(0.0, 1.0);
  for (std::size_t cell = 0; cell < kGuardCells; ++cell) {
    tracker.take(5.0, 1.0);
    EXPECT_EQ(tracker.next_cell().value_codes, 0.0);
  }
  tracker.take(5.0, 1.0);
  EXPECT_GT(tracker.next_cell().value_codes, 1.0);
}

TEST(BaselineTracker, NoiseIsTheMeanSquareAboutThePrediction) {
  BaselineTracker tracker({256, 20000, 40});
  tracker.start({{0.0, 0.0}, 1.0, 0.1}, 256);
  for (int cell = 0; cell < 2000; ++cell) tracker.take(0.0, 4.0);
  EXPECT_NEAR(tracker.noise_variance(), 4.0, 0.01);
  EXPECT_LT(tracker.noise_relative_variance(), 2.0 / 20000.0);
}

}  // namespace
}  // namespace kolsky

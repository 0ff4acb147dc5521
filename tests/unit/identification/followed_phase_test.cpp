#include "processing/identification/followed_phase.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

namespace kolsky {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr std::size_t kBins = 200;

double true_phase(std::size_t k) {
  return 0.12 * static_cast<double>(k) - 2e-4 * static_cast<double>(k * k);
}

struct Reading {
  double phase_rad;
  double variance_rad2;
};

/// Of a signal of this size in complex noise of unit power per part.
Reading reading(double phase_rad, double size, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const std::complex<double> value =
      std::polar(size, phase_rad) + std::complex<double>(normal(random), normal(random));
  return {std::arg(value), 1.0 / std::norm(value)};
}

/// Of 500 draws, those in which a phase that stands well out of the noise has a turn too many.
int slips(const std::function<double(std::size_t)>& size_at) {
  std::mt19937_64 random(7);
  int slipped = 0;
  for (int draw = 0; draw < 500; ++draw) {
    FollowedPhase phase;
    bool any = false;
    for (std::size_t k = 0; k < kBins; ++k) {
      const Reading one = reading(true_phase(k), size_at(k), random);
      const double followed = phase.at_next(one.phase_rad, one.variance_rad2);
      any = any || (size_at(k) > 10.0 && std::abs(followed - true_phase(k)) > kTurn / 2.0);
    }
    slipped += any ? 1 : 0;
  }
  return slipped;
}

TEST(FollowedPhase, GoesOnOverManyTurns) {
  FollowedPhase phase;
  double last = 0.0;
  for (std::size_t k = 0; k < 1000; ++k) {
    const double truth = 0.5 * static_cast<double>(k);
    last = phase.at_next(std::remainder(truth, kTurn), 1e-6);
    ASSERT_NEAR(last, truth, 1e-9);
  }
  EXPECT_GT(last, 70.0 * kTurn);
}

TEST(FollowedPhase, IsNotLedAstrayByLowestFrequenciesThatHoldNoiseAlone) {
  EXPECT_EQ(slips([](std::size_t k) { return k < 5 ? 0.0 : 100.0; }), 0);
}

// A pulse of 200 us holds next to nothing at 5 kHz.
TEST(FollowedPhase, GoesOnBehindNullsOfThePulse) {
  EXPECT_EQ(slips([](std::size_t k) { return k % 50 > 44 ? 0.0 : 100.0; }), 0);
}

TEST(FollowedPhase, GoesOnBehindAGradualNull) {
  EXPECT_EQ(slips([](std::size_t k) {
              return 100.0 * std::abs(std::sin(std::numbers::pi * static_cast<double>(k) / 60.0));
            }),
            0);
}

// What half a turn of noise does to a single reading is in that reading alone.
TEST(FollowedPhase, TakesNothingFromAReadingThatSaysNothing) {
  FollowedPhase with;
  FollowedPhase without;
  for (std::size_t k = 0; k < kBins; ++k) {
    const bool nothing = k == 20 || k == 21;
    const double truth = 0.1;
    const double a = with.at_next(nothing ? truth + 0.49 * kTurn : truth,
                                  nothing ? std::numeric_limits<double>::infinity() : 1e-4);
    const double b = without.at_next(truth, 1e-4);
    if (!nothing) {
      ASSERT_DOUBLE_EQ(a, b) << k;
    }
  }
}

}  // namespace
}  // namespace kolsky

// What a first gauge's noise shows at others in a bin, against sums over the noise's every sample
// of an impulse that runs to and fro.
#include "processing/identification/noise_arrivals.hpp"

#include <gtest/gtest.h>

#include <array>
#include <complex>
#include <numbers>

namespace kolsky {
namespace {

constexpr int kLead = 130;     // samples of record before what is judged
constexpr int kJudged = 1000;  // samples
constexpr std::array kFirst{60, 110};
constexpr std::array kBack{140, 40};
constexpr int kTurn = 260;

using Waves = std::array<Complex, kFirst.size()>;

/// What an impulse that the first gauge reads makes of a bin at the others, of what falls into the
/// judged samples: a wave that a free end turns round and whoever is before the gauge sends on.
Waves bin_of_impulse(int at, double cycles, double kept_per_sample) {
  Waves waves{};
  const auto arrive = [&](std::size_t j, int late, double sign) {
    const int n = at + late;
    if (n >= 0 && n < kJudged) {
      waves[j] += sign * std::pow(kept_per_sample, late) *
                  std::polar(1.0, -2.0 * std::numbers::pi * cycles * n);
    }
  };
  for (int turned = 0; turned < kLead + kJudged; turned += kTurn) {
    for (std::size_t j = 0; j < waves.size(); ++j) {
      arrive(j, turned + kFirst[j], 1.0);
      arrive(j, turned + kFirst[j] + kBack[j], -1.0);
    }
  }
  return waves;
}

void expect_sums(double kept_per_sample) {
  NoiseArrivals::Times times;
  times.lead_s = kLead;
  times.judged_s = kJudged;
  times.turn_s = kTurn;
  times.first_s = {kFirst[0], kFirst[1]};
  times.back_s = {kBack[0], kBack[1]};
  const NoiseArrivals arrivals(times);
  for (const int bin : {1, 7, 30, 31, 32, 33, 34, 35, 36, 211}) {
    SCOPED_TRACE(bin);
    const double cycles = static_cast<double>(bin) / kJudged;
    const auto way = [&](int samples) {
      return std::pow(kept_per_sample, samples) *
             std::polar(1.0, -2.0 * std::numbers::pi * cycles * samples);
    };
    const std::array first{way(kFirst[0]), way(kFirst[1])};
    const std::array back{-way(kBack[0]), -way(kBack[1])};
    const NoiseArrivals::Shown shown = arrivals.shown(first, back, way(kTurn));
    Eigen::Matrix2cd mean_square = Eigen::Matrix2cd::Zero();
    Eigen::Vector2cd mean = Eigen::Vector2cd::Zero();
    for (int at = -kLead; at < kJudged; ++at) {
      const Waves waves = bin_of_impulse(at, cycles, kept_per_sample);
      const Eigen::Vector2cd sum(waves[0], waves[1]);
      mean_square += sum * sum.adjoint() / kJudged;
      if (at >= 0) {
        mean += sum * std::polar(1.0, 2.0 * std::numbers::pi * cycles * at) / kJudged;
      }
    }
    // Moments are samples here, of which an edge may take one more or less.
    EXPECT_LT((shown.mean_square - mean_square).norm(), 0.01 * mean_square.norm());
    EXPECT_LT((shown.mean - mean).norm(), 0.01);
  }
}

TEST(NoiseArrivals, AreThoseOfEveryMomentInABarWithoutLoss) {
  expect_sums(1.0);
}

TEST(NoiseArrivals, AreThoseOfEveryMomentInABarThatLoses) {
  expect_sums(0.999);
}

TEST(NoiseArrivals, PassOnceWhereNothingComesBack) {
  NoiseArrivals::Times times{
      .first_s = {60.0}, .back_s = {}, .turn_s = 260.0, .lead_s = 130.0, .judged_s = 1000.0};
  const std::array first{Complex(0.6, 0.8)};
  const std::array back{Complex(0.0)};
  const auto shown = NoiseArrivals(times).shown(first, back, 0.0);
  EXPECT_NEAR(shown.mean_square(0, 0).real(), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(shown.mean[0] - 0.94 * first[0]), 0.0, 1e-12);
  times.lead_s = 30.0;  // noise of the 30 samples before is all that the first 60 can show
  EXPECT_NEAR(NoiseArrivals(times).shown(first, back, 0.0).mean_square(0, 0).real(), 0.97, 1e-12);
}

}  // namespace
}  // namespace kolsky

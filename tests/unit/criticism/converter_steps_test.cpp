#include "processing/criticism/noise/converter_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace kolsky {
namespace {

constexpr std::size_t kSamples = 600;
constexpr double kStep = 2e-5;

/// A tail that creeps back over nine steps.
std::vector<double> creeping() {
  std::vector<double> record(kSamples);
  for (std::size_t n = 0; n < kSamples; ++n) {
    record[n] = 9.0 * kStep * std::exp(-static_cast<double>(n) / 250.0);
  }
  return record;
}

std::vector<double> rounded(std::vector<double> record, double noise_sd, std::mt19937_64& random) {
  std::uniform_real_distribution<double> anywhere(-0.5, 0.5);
  std::normal_distribution<double> noise(0.0, noise_sd);
  const double offset = anywhere(random) * kStep;
  for (double& value : record) {
    value = kStep * std::round((value + offset + noise(random)) / kStep) - offset;
  }
  return record;
}

double power_at(std::size_t bin, const std::vector<double>& record) {
  std::complex<double> sum = 0.0;
  for (std::size_t n = 0; n < record.size(); ++n) {
    sum += std::polar(record[n], -2.0 * std::numbers::pi * static_cast<double>(bin * n % kSamples) /
                                     static_cast<double>(kSamples));
  }
  return std::norm(sum);
}

class RoundingPower : public ::testing::TestWithParam<double> {};

TEST_P(RoundingPower, IsWhatRoundingLeavesAtLowFrequencies) {
  const double noise_sd = GetParam() * kStep;
  const std::vector<double> clean = creeping();
  constexpr std::size_t kBins = 16;
  constexpr int kRepeats = 1500;
  DampedTransform transform(kSamples, 1e-6, 1.0);
  const std::vector<double> expected = rounding_power(transform, clean, kStep, noise_sd, kBins);
  std::mt19937_64 random(3);
  double seen = 0.0;
  double white = 0.0;  // far above what the steps of so slow a record make
  for (int i = 0; i < kRepeats; ++i) {
    std::vector<double> error = rounded(clean, noise_sd, random);
    for (std::size_t n = 0; n < kSamples; ++n) {
      error[n] -= clean[n];
    }
    for (std::size_t k = 1; k <= kBins; ++k) {
      seen += power_at(k, error) / kRepeats;
      white += noise_sd > 0.0 ? power_at(k + 270, error) / kRepeats : 0.0;
    }
  }
  double sum = 0.0;
  for (const double power : expected) {
    sum += power;
  }
  EXPECT_NEAR(seen, sum + white, 0.06 * seen);
  EXPECT_GT(sum, white) << "the test shows nothing";
}

INSTANTIATE_TEST_SUITE_P(Noise, RoundingPower, ::testing::Values(0.0, 0.1, 0.2));

TEST(UnroundedSd, IsThatOfTheNoiseThoughTheRecordAtRestShowsNone) {
  for (const double wanted : {0.1, 0.2, 0.3}) {
    std::mt19937_64 random(5);
    std::vector<std::vector<double>> records;
    for (int i = 0; i < 200; ++i) {
      std::vector<double> record(300, 0.0);
      for (const double value : creeping()) {
        record.push_back(value);
      }
      records.push_back(rounded(record, wanted * kStep, random));
    }
    const std::vector<std::span<const double>> views(records.begin(), records.end());
    EXPECT_NEAR(unrounded_sd(views, kStep) / kStep, wanted, 0.05) << wanted;
  }
}

// A stretch with a pulse's top in it ends as few steps from where it began as a slow one does.
TEST(UnroundedSd, IsNotTakenFromPulses) {
  constexpr double kWanted = 0.1;
  std::mt19937_64 random(6);
  std::vector<std::vector<double>> records;
  for (int i = 0; i < 50; ++i) {
    std::vector<double> record(300, 0.0);
    for (int n = 0; n < 80; ++n) {
      record.push_back(40.0 * kStep * std::sin(std::numbers::pi * n / 80.0));
    }
    for (const double value : creeping()) {
      record.push_back(value);
    }
    records.push_back(rounded(record, kWanted * kStep, random));
  }
  const std::vector<std::span<const double>> views(records.begin(), records.end());
  EXPECT_NEAR(unrounded_sd(views, kStep) / kStep, kWanted, 0.05);
}

TEST(RoundingAt, IsWhatRoundingDoesToARecordThere) {
  constexpr double kNoise = 0.15;
  const RoundingAt rounding(kStep, kNoise * kStep);
  std::mt19937_64 random(7);
  std::normal_distribution<double> noise(0.0, kNoise * kStep);
  for (const double place : {-3.2, -0.5, 0.0, 0.3, 0.45, 0.6, 7.5}) {
    constexpr int kRepeats = 40000;
    const double strain = place * kStep;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kRepeats; ++i) {
      const double read = std::round((strain + noise(random)) / kStep);
      sum += read / kRepeats;
      squares += read * read / kRepeats;
    }
    EXPECT_NEAR(rounding.mean(strain) / kStep, sum - place, 0.02) << place;
    const double beyond = std::max(0.0, squares - sum * sum - 1.0 / 12.0);
    EXPECT_NEAR(rounding.variance_beyond(strain) / (kStep * kStep), beyond, 0.02) << place;
  }
}

TEST(UnroundedSd, IsUnknownWhereNothingMoves) {
  const std::vector<double> rest(500, 3.0 * kStep);
  const std::vector<std::span<const double>> views{rest};
  EXPECT_EQ(unrounded_sd(views, kStep), 0.0);
}

}  // namespace
}  // namespace kolsky

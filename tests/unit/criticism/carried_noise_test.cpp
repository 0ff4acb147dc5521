#include "processing/criticism/noise/carried_noise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

namespace kolsky {
namespace {

constexpr std::size_t kJudged = 96;
constexpr std::size_t kBefore = 12;
constexpr std::size_t kQuiet = 20;
constexpr std::size_t kRecord = kJudged + 2 * kBefore;
constexpr std::size_t kBins = 10;

std::vector<double> slow_noise(double keep, double white, std::size_t samples,
                               std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<double> out(samples);
  double value = normal(random);
  for (double& sample : out) {
    value = keep * value + std::sqrt(1.0 - keep * keep) * normal(random);
    sample = value + white * normal(random);
  }
  return out;
}

/// Echoes of one sample each, shrinking by `share`; the first at no lag.
std::vector<double> echoes(double share, std::size_t apart) {
  std::vector<double> k(kRecord, 0.0);
  double height = 1.0;
  for (std::size_t lag = 0; kBefore + lag < kRecord; lag += apart) {
    k[kBefore + lag] = height;
    height *= share;
  }
  return k;
}

/// Mean squares at the bins of what filters make of records of noise less their quiet mean, by
/// drawing and convolving them.
std::vector<Eigen::MatrixXcd> drawn(const std::vector<std::vector<double>>& filters, double keep,
                                    double white, int draws) {
  std::mt19937_64 random(5);
  const auto rows = static_cast<Eigen::Index>(filters.size());
  std::vector<Eigen::MatrixXcd> power(kBins, Eigen::MatrixXcd::Zero(rows, rows));
  for (int draw = 0; draw < draws; ++draw) {
    std::vector<double> n = slow_noise(keep, white, kRecord, random);
    double mean = 0.0;
    for (std::size_t i = 0; i < kQuiet; ++i) {
      mean += n[i] / static_cast<double>(kQuiet);
    }
    Eigen::MatrixXcd X = Eigen::MatrixXcd::Zero(rows, kBins);
    for (Eigen::Index f = 0; f < rows; ++f) {
      for (std::size_t t = 0; t < kJudged; ++t) {
        double x = 0.0;
        for (std::size_t u = 0; u <= t + kBefore; ++u) {
          x += filters[static_cast<std::size_t>(f)][kBefore + t + kBefore - u] * (n[u] - mean);
        }
        for (std::size_t k = 0; k < kBins; ++k) {
          X(f, static_cast<Eigen::Index>(k)) +=
              x * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>((k + 1) * t) /
                                      static_cast<double>(kJudged));
        }
      }
    }
    for (std::size_t k = 0; k < kBins; ++k) {
      const auto column = X.col(static_cast<Eigen::Index>(k));
      power[k] += column * column.adjoint() / static_cast<double>(draws);
    }
  }
  return power;
}

NoiseSpectrum measured(double keep, double white) {
  std::mt19937_64 random(3);
  std::vector<std::vector<double>> stretches;
  std::vector<std::span<const double>> quiet;
  for (int i = 0; i < 400; ++i) {
    stretches.push_back(slow_noise(keep, white, 512, random));
  }
  quiet.assign(stretches.begin(), stretches.end());
  return NoiseSpectrum(quiet);
}

void expect_as_drawn(double keep, double white, double allowed) {
  const std::vector<std::vector<double>> filters{echoes(-0.95, 25), echoes(0.8, 16)};
  const CarriedNoise noise(measured(keep, white), 1e-12, {kJudged, kBefore, kQuiet, 1, 0.5}, kBins);
  CarriedNoise::Memory memory;
  std::vector<CarriedBin> bins;
  noise.through(filters, memory, bins);
  const auto wanted = drawn(filters, keep, white, 4000);
  for (std::size_t k = 0; k < kBins; ++k) {
    EXPECT_NEAR(bins[k].power(0, 0).real() / wanted[k](0, 0).real(), 1.0, allowed) << k;
    EXPECT_NEAR(bins[k].power(1, 1).real() / wanted[k](1, 1).real(), 1.0, allowed) << k;
    const double scale = std::sqrt(wanted[k](0, 0).real() * wanted[k](1, 1).real());
    EXPECT_NEAR(std::abs(bins[k].power(0, 1) - wanted[k](0, 1)) / scale, 0.0, allowed) << k;
  }
}

// 4000 draws tell a power to 1.6 %, one deviation.
TEST(CarriedNoise, WhiteNoiseRingsUpAsDrawnRecordsDo) {
  expect_as_drawn(0.0, 1.0, 0.08);
}

TEST(CarriedNoise, SlowNoiseAndItsBaselineRingUpAsDrawnRecordsDo) {
  expect_as_drawn(0.95, 0.5, 0.1);
}

std::vector<CarriedBin> carried(const CarriedNoise& noise,
                                const std::vector<std::vector<double>>& filters,
                                CarriedNoise::Memory& memory) {
  std::vector<CarriedBin> bins;
  noise.through(filters, memory, bins);
  return bins;
}

// What is remembered of other responses changes no bit of a result.
TEST(CarriedNoise, RemembersOnlyWhatHasNotChanged) {
  const CarriedNoise noise(measured(0.95, 0.5), 1e-12, {kJudged, kBefore, kQuiet, 1, 0.5}, kBins);
  const std::vector<double> nothing(kRecord, 0.0);
  std::vector<std::vector<double>> brief{echoes(0.5, 30)};
  std::fill(brief[0].begin() + kBefore + 31, brief[0].end(), 0.0);
  const std::vector<std::vector<std::vector<double>>> calls{
      {echoes(-0.95, 25), echoes(0.8, 16), brief[0]},
      {echoes(-0.95, 25), echoes(0.7, 16), brief[0]},
      {echoes(-0.9, 25), echoes(0.8, 16), nothing},
      {echoes(-0.95, 25), echoes(0.8, 16), brief[0]},
      {echoes(0.8, 16)},
      {nothing, echoes(0.8, 16)}};
  CarriedNoise::Memory memory;
  for (int round = 0; round < 3; ++round) {
    for (const auto& filters : calls) {
      CarriedNoise::Memory none;
      const auto wanted = carried(noise, filters, none);
      const auto bins = carried(noise, filters, memory);
      for (std::size_t k = 0; k < kBins; ++k) {
        EXPECT_EQ(bins[k].power, wanted[k].power) << k;
        EXPECT_EQ(bins[k].ratio, wanted[k].ratio) << k;
      }
    }
  }
}

}  // namespace
}  // namespace kolsky

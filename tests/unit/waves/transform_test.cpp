#include "processing/waves/transform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "processing/waves/band_limit.hpp"

namespace kolsky {
namespace {

std::vector<double> noise_record(std::size_t samples) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::vector<double> record(samples);
  for (double& value : record) {
    value = normal(random);
  }
  return record;
}

TEST(TransformLength, IsQuickWhereATenthMoreHoldsTwoMoreOften) {
  EXPECT_EQ(good_transform_length(4290), 4320U);
  EXPECT_EQ(quick_transform_length(4290), 4608U);
  EXPECT_EQ(quick_transform_length(4096), 4096U);
  EXPECT_EQ(quick_transform_length(4098), 4320U) << "4608 is too far";
}

TEST(DampedTransform, IsTheLaplaceSum) {
  const auto record = noise_record(60);
  DampedTransform transform(record.size(), 1e-6);
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(record, spectrum);
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    Complex sum = 0.0;
    for (std::size_t n = 0; n < record.size(); ++n) {
      sum += record[n] * std::exp(-transform.s(k) * (1e-6 * static_cast<double>(n)));
    }
    EXPECT_NEAR(std::abs(spectrum[k] - sum), 0.0, 1e-12);
  }
}

TEST(DampedTransform, ComesBackToTheRecord) {
  for (const std::size_t samples : {16U, 997U, 4096U}) {
    const auto record = noise_record(samples);
    DampedTransform transform(samples, 1e-6);
    EXPECT_GE(transform.length(), samples);
    std::vector<Complex> spectrum(transform.bins());
    std::vector<double> back(samples);
    transform.forward(record, spectrum);
    transform.inverse(spectrum, back);
    for (std::size_t n = 0; n < samples; ++n) {
      // Damping by 1e-8 and back leaves 1e-16 / 1e-8 at the end.
      EXPECT_NEAR(back[n], record[n], 1e-7);
    }
  }
}

TEST(DampedTransform, APartIsThatPartOfTheWhole) {
  const auto record = noise_record(60);
  DampedTransform transform(record.size(), 1e-6);
  std::vector<Complex> whole(transform.bins());
  transform.forward(record, whole);
  std::vector<Complex> first(7);
  transform.forward(record, first);
  EXPECT_TRUE(std::equal(first.begin(), first.end(), whole.begin()));
  std::fill(whole.begin() + 7, whole.end(), 0.0);
  std::vector<double> low(record.size());
  transform.inverse(whole, low);
  std::vector<double> cut(20);
  transform.inverse(first, cut, 13);
  EXPECT_TRUE(std::equal(cut.begin(), cut.end(), low.begin() + 13));
}

TEST(BandLimit, PassesHalfAtTheLimitInOneStepOrTwo) {
  DampedTransform transform(2000, 1e-6, 1.0);
  BandLimit band(transform, 16);
  std::vector<Complex> whole(60, 1.0);
  std::vector<Complex> twice(60, 1.0);
  band.apply(20e3, whole);
  band.apply_half(20e3, twice);
  EXPECT_NEAR(std::norm(twice[40]), 0.5, 1e-12) << "40 bins of 500 Hz";
  band.apply_half(20e3, twice);
  for (std::size_t k = 0; k < whole.size(); ++k) {
    EXPECT_NEAR(std::abs(whole[k] - twice[k]), 0.0, 1e-15) << k;
  }
  EXPECT_NEAR(whole[40].real(), 0.5, 1e-12);
}

TEST(DampedTransform, ADelayPushesTheEndOutInsteadOfRoundTheCorner) {
  std::vector<double> record(1000, 0.0);
  for (std::size_t n = 900; n < 1000; ++n) {
    record[n] = 1.0;
  }
  DampedTransform transform(record.size(), 1e-6);
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(record, spectrum);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= std::exp(-transform.s(k) * 200e-6);
  }
  std::vector<double> delayed(record.size());
  transform.inverse(spectrum, delayed);
  for (const double value : delayed) {
    EXPECT_NEAR(value, 0.0, 1e-6);  // the Fourier transform would put 1 at samples 100 to 199
  }
}

TEST(DampedTransform, ACutRecordLeaksNothingIntoWhatWasBefore) {
  // An echo recursion, y = x + y delayed: with x cut at the end, y before the end is not touched.
  std::vector<double> record(1000, 0.0);
  for (std::size_t n = 950; n < 1000; ++n) {
    record[n] = 1.0;
  }
  record[100] = 1.0;
  DampedTransform transform(record.size(), 1e-6);
  std::vector<Complex> spectrum(transform.bins());
  transform.forward(record, spectrum);
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] /= 1.0 - std::exp(-transform.s(k) * 300e-6);
  }
  std::vector<double> echoes(record.size());
  transform.inverse(spectrum, echoes);
  for (std::size_t n = 0; n < 950; ++n) {
    const double expected = (n >= 100 && (n - 100) % 300 == 0) ? 1.0 : 0.0;
    EXPECT_NEAR(echoes[n], expected, 1e-6) << n;
  }
}

}  // namespace
}  // namespace kolsky

// Against a quantiser that is stepped through all of its offsets.
#include "processing/uncertainty/converter_steps.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "processing/uncertainty/scatter.hpp"

namespace kolsky {
namespace {

constexpr double kStep = 1000.0;

/// Codes of a constant under normal noise of that many steps.
std::vector<std::int32_t> quantised(double constant, double sigma, std::size_t samples,
                                    std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<std::int32_t> codes;
  for (std::size_t n = 0; n < samples; ++n) {
    codes.push_back(
        static_cast<std::int32_t>(kStep * std::round(constant + sigma * noise(random))));
  }
  codes.back() += static_cast<std::int32_t>(kStep);  // so that there is a step
  return codes;
}

class OfNoise : public ::testing::TestWithParam<double> {};

// What is left of a baseline's error, rms over offsets: no more than is drawn, nor half of it.
TEST_P(OfNoise, IsWhatABaselineIsOffBy) {
  const double sigma = GetParam();
  std::mt19937 random(3);
  double off = 0.0;
  double drawn = 0.0;
  constexpr int kOffsets = 200;
  for (int i = 0; i < kOffsets; ++i) {
    const double constant = 0.3 + (i + 0.5) / kOffsets;
    const auto codes = quantised(constant, sigma, 4000, random);
    double mean = 0.0;
    for (std::size_t n = 0; n + 1 < codes.size(); ++n) {
      mean += codes[n] / (kStep * static_cast<double>(codes.size() - 1));
    }
    off += std::pow(mean - constant, 2) / kOffsets;
    const ConverterSteps steps(codes, codes.size() - 1);
    EXPECT_EQ(steps.step(), kStep);
    drawn += std::pow(steps.undithered(), 2) / 12.0 / kOffsets;
  }
  EXPECT_LT(std::sqrt(off), 1.2 * std::sqrt(drawn) + 0.02);
  EXPECT_GT(std::sqrt(off), 0.5 * std::sqrt(drawn) - 0.02);
}
INSTANTIATE_TEST_SUITE_P(ConverterSteps, OfNoise, ::testing::Values(0.0, 0.1, 0.2, 0.3, 0.5, 1.0));

TEST(ConverterSteps, AddOneErrorToAStandingRecordAndScatterToAPassingOne) {
  std::vector<std::int32_t> codes(20, 0);
  codes.insert(codes.end(), 30, 3000);  // stands at its top
  for (int n = 2; n >= 0; --n) {
    codes.insert(codes.end(), 8, 1000 * n);  // passes through
  }
  const ConverterSteps steps(codes, 20);
  EXPECT_EQ(steps.undithered(), 1.0);
  std::vector<double> tops;
  std::vector<double> passing;
  for (std::uint64_t draw = 0; draw < 2000; ++draw) {
    RandomStream random(1, draw);
    std::vector<double> values(codes.size(), 0.0);
    steps.add(random, values);
    EXPECT_EQ(values[0], 0.0);
    EXPECT_EQ(values[20], values[49]);
    tops.push_back(values[20]);
    passing.push_back(values[51] - values[52]);
  }
  // Its own error and the baseline's, and the difference of two of its own.
  EXPECT_NEAR(sd_of(tops), kStep / std::sqrt(6.0), 0.05 * kStep);
  EXPECT_NEAR(sd_of(passing), kStep / std::sqrt(6.0), 0.05 * kStep);
}

TEST(ConverterSteps, OfARecordThatStandsStillAreNone) {
  const std::vector<std::int32_t> codes(50, 7);
  EXPECT_FALSE(ConverterSteps(codes, 20).matters());
}

}  // namespace
}  // namespace kolsky

#include "drivers/files/tables/quantise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <random>

namespace kolsky {
namespace {

void expect_fine(const std::vector<double>& values) {
  const QuantisedValues quantised = quantise(values);
  int exponent = 0;
  EXPECT_EQ(std::frexp(quantised.scale, &exponent), 0.5) << "scale is no power of two";
  double largest = 0.0;
  for (const double value : values) {
    largest = std::max(largest, std::abs(value));
  }
  ASSERT_EQ(quantised.codes.size(), values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_GT(quantised.codes[i], INT32_MIN);
    EXPECT_LT(quantised.codes[i], INT32_MAX);
    EXPECT_LE(std::abs(quantised.codes[i] * quantised.scale - values[i]), 5e-10 * largest);
  }
}

TEST(Quantise, RoundsBelowHalfABillionthOfTheLargest) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> sample(-1.0, 1.0);
  std::uniform_real_distribution<double> decade(-12.0, 3.0);
  for (int trial = 0; trial < 200; ++trial) {
    const double size = std::pow(10.0, decade(random));
    std::vector<double> values(50);
    for (double& value : values) {
      value = size * sample(random);
    }
    expect_fine(values);
  }
}

// Just below, at and just above a power of two the largest code is near the end of its range.
TEST(Quantise, KeepsInsideTheEndsAtPowersOfTwo) {
  for (const double largest : {1.0, std::nextafter(1.0, 0.0), std::nextafter(1.0, 2.0), 0.125,
                               1.0 - std::ldexp(1.0, -31), 1.0 - std::ldexp(1.0, -32)}) {
    expect_fine({largest, -largest, 0.5 * largest, 0.0});
  }
}

TEST(Quantise, TakesSilenceAndTinyValues) {
  EXPECT_EQ(quantise(std::vector<double>{0.0, -0.0}).codes, (std::vector<std::int32_t>{0, 0}));
  const QuantisedValues tiny = quantise(std::vector<double>{5e-324, 0.0});
  EXPECT_GT(tiny.scale, 0.0);
  EXPECT_TRUE(quantise(std::vector<double>{}).codes.empty());
}

TEST(Quantise, GivesRecordsBelowOneFullScaleOneScale) {
  const double scale = quantise(std::vector<double>{0.9}, 1.0).scale;
  EXPECT_EQ(quantise(std::vector<double>{1e-6, 0.0}, 1.0).scale, scale);
  EXPECT_EQ(quantise(std::vector<double>{}, 1.0).scale, scale);
  EXPECT_GT(quantise(std::vector<double>{-5.0}, 1.0).scale, scale) << "or its codes would overflow";
}

// Codes of a 16-bit converter with a power of two per step come back exactly.
TEST(Quantise, IsExactForConverterSteps) {
  std::vector<double> values;
  for (int code = -32768; code < 32768; code += 17) {
    values.push_back(code * std::ldexp(1.0, -13));
  }
  const QuantisedValues quantised = quantise(values);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(quantised.codes[i] * quantised.scale, values[i]);
  }
}

}  // namespace
}  // namespace kolsky

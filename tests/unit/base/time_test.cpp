#include "processing/base/time.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace kolsky {
namespace {

TEST(SampleRate, IsExactForWholeHertz) {
  EXPECT_EQ(SampleRate::from_Hz(1e6), (SampleRate{1'000'000, 1}));
  EXPECT_EQ(SampleRate::from_Hz(125e6), (SampleRate{125'000'000, 1}));
  EXPECT_EQ(SampleRate::from_Hz(31.25e6), (SampleRate{31'250'000, 1}));
  EXPECT_EQ(SampleRate::from_Hz(1.0), (SampleRate{1, 1}));
}

TEST(SampleRate, KeepsFractionsInLowestTerms) {
  EXPECT_EQ(SampleRate::from_Hz(0.5), (SampleRate{1, 2}));
  EXPECT_EQ(SampleRate::from_Hz(44100.25), (SampleRate{176'401, 4}));
  EXPECT_NEAR(SampleRate::from_Hz(1e6 / 3.0).Hz(), 1e6 / 3.0, 1e-6);
}

TEST(SampleRate, PeriodIsTheInverse) {
  const SampleRate rate{2'000'000, 3};
  EXPECT_DOUBLE_EQ(rate.Hz() * rate.period_s(), 1.0);
  EXPECT_DOUBLE_EQ(rate.period_s(), 1.5e-6);
}

TEST(SampleRate, OfNothingIsNone) {
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e13}) {
    EXPECT_EQ(SampleRate::from_Hz(bad), (SampleRate{0, 1})) << bad;
  }
}

}  // namespace
}  // namespace kolsky

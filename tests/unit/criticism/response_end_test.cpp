#include "processing/criticism/noise/response_end.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/waves/transform.hpp"

namespace kolsky {
namespace {

constexpr double kGrowth = 0.01;
constexpr double kShare = 3e-10;  // of the peak, that cannot be told from ripples before they grow

double ripple_at(std::size_t place) {
  return kShare * std::exp(kGrowth * static_cast<double>(place));
}

TEST(ResponseEnd, TheTailBelowTheRipplesGoesAndNothingBeforeIt) {
  constexpr std::size_t kFirst = 40;
  constexpr std::size_t kLast = 60;  // that stands above
  std::vector<double> response(100, 0.0);
  response[10] = -1.0;
  for (std::size_t n = 20; n < response.size(); ++n) {
    response[n] = (n % 2 == 0 ? 0.9 : -0.9) * ripple_at(kFirst + n);
  }
  response[kLast] = -1.1 * ripple_at(kFirst + kLast);
  std::vector<double> ended = response;
  end_where_unresolved(ended, kGrowth, kFirst);
  for (std::size_t n = 0; n < response.size(); ++n) {
    EXPECT_EQ(ended[n], n <= kLast ? response[n] : 0.0) << n;
  }
}

TEST(ResponseEnd, RipplesAreAsLargeAsThePeakAndThePlaceMakeThem) {
  const std::vector<double> response = {1.0, 0.0, 2.0 * kShare};
  std::vector<double> resolved = response;
  end_where_unresolved(resolved, 0.0, 1000);
  EXPECT_EQ(resolved, response);
  std::vector<double> later = response;
  end_where_unresolved(later, kGrowth, 100);
  EXPECT_EQ(later.back(), 0.0);
  std::vector<double> beside_more = {3.0, 0.0, 2.0 * kShare};
  end_where_unresolved(beside_more, 0.0, 0);
  EXPECT_EQ(beside_more.back(), 0.0);
}

TEST(ResponseEnd, WhatIsHeardAtTheEndStays) {
  std::vector<double> response = {0.0, 1.0, 0.0, 0.0, 0.5};
  const std::vector<double> before = response;
  end_where_unresolved(response, kGrowth, 7);
  EXPECT_EQ(response, before);
}

TEST(ResponseEnd, NothingAndSilenceHaveNoEnd) {
  std::vector<double> nothing;
  end_where_unresolved(nothing, kGrowth, 0);
  EXPECT_TRUE(nothing.empty());
  std::vector<double> silence(5, 0.0);
  end_where_unresolved(silence, kGrowth, 0);
  EXPECT_EQ(silence, std::vector<double>(5, 0.0));
}

/// As it is used: a bell that is over early, through a low-passed spectrum that ends, to a record
/// damped to 1e-8. Behind the bell there is nothing, but undamping shows more and more of it.
TEST(ResponseEnd, OfABellThroughADampedTransformTheBellIsLeft) {
  constexpr std::size_t kSamples = 2000;
  constexpr double kDamping = 1e-8;
  constexpr double kPlace = 300.0;
  constexpr double kWidth = 12.0;
  DampedTransform transform(kSamples, 1.0, kDamping);
  const double growth = transform.s(0).real();
  std::vector<Complex> spectrum;
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    const Complex s = transform.s(k);
    const Complex bell = std::exp(0.5 * kWidth * kWidth * s * s - kPlace * s);
    if (std::abs(std::exp(0.5 * kWidth * kWidth * s * s)) < 1e-11) {
      break;
    }
    spectrum.push_back(bell);
  }
  ASSERT_LT(spectrum.size(), transform.bins());
  std::vector<double> response(kSamples);
  transform.inverse(spectrum, response);
  const auto largest_behind = [](const std::vector<double>& values) {
    const auto from = values.begin() + static_cast<std::ptrdiff_t>(kPlace + 10.0 * kWidth);
    return std::abs(*std::max_element(
        from, values.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }));
  };
  const double peak = 1.0 / (kWidth * std::sqrt(2.0 * std::numbers::pi));
  ASSERT_GT(largest_behind(response), 1e-9 * peak);
  end_where_unresolved(response, growth, 0);
  EXPECT_EQ(largest_behind(response), 0.0);
  for (std::size_t n = 0; n < kSamples; ++n) {
    const double away = (static_cast<double>(n) - kPlace) / kWidth;
    EXPECT_NEAR(response[n], peak * std::exp(-0.5 * away * away), 1e-8 * peak) << n;
  }
}

}  // namespace
}  // namespace kolsky

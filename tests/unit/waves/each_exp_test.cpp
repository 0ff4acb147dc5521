#include "processing/waves/each_exp.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace kolsky {
namespace {

// Of long double, a few last digits of double are known.
TEST(EachExp, IsTheExponentialOfEach) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> decay(-40.0, 10.0);
  std::uniform_real_distribution<double> angle(-500.0, 500.0);
  for (const std::size_t count : {1U, 127U, 128U, 129U, 1000U}) {
    std::vector<Complex> values(count);
    for (Complex& value : values) {
      value = {decay(random), angle(random)};
    }
    std::vector<Complex> out = values;
    each_exp(out);
    for (std::size_t i = 0; i < count; ++i) {
      const auto wanted = std::exp(std::complex<long double>(values[i].real(), values[i].imag()));
      EXPECT_LT(std::abs(std::complex<long double>(out[i]) - wanted), 2e-15L * std::abs(wanted))
          << values[i];
    }
  }
}

TEST(EachExp, OfNothingIsNothing) {
  std::vector<Complex> none;
  each_exp(none);
  std::vector<Complex> far{{-1e4, 3.0}, {0.0, 0.0}};
  each_exp(far);
  EXPECT_EQ(std::abs(far[0]), 0.0);
  EXPECT_EQ(far[1], Complex(1.0));
}

}  // namespace
}  // namespace kolsky

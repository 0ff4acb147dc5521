#include "processing/identification/bar_misfit.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace kolsky {
namespace {

// Points of the F distribution as printed tables have them; Paulson's approximation is good to
// 0.05.
TEST(BarMisfit, RatiosOfVariancesAreAsRareAsTheTablesSay) {
  EXPECT_NEAR(normal_of_variance_ratio(2.348, 10.0, 20.0), 1.6449, 0.05);
  EXPECT_NEAR(normal_of_variance_ratio(5.636, 5.0, 10.0), 2.3263, 0.05);
  EXPECT_NEAR(normal_of_variance_ratio(7.005, 12.0, 12.0), 3.0902, 0.05);
}

std::vector<OctaveLeft> drawn(std::size_t shots, double wrong, std::mt19937_64& random) {
  std::vector<OctaveLeft> left;
  for (const double numbers : {12.0, 12.0, 24.0, 48.0, 96.0}) {
    std::chi_squared_distribution<double> common(numbers);
    std::chi_squared_distribution<double> apart(numbers * (static_cast<double>(shots) - 1.0));
    OctaveLeft octave;
    octave.numbers = octave.count_as = numbers;
    octave.in_common = (1.0 + wrong) * common(random) / numbers;
    octave.of_all = (octave.in_common + apart(random) / numbers) / static_cast<double>(shots);
    left.push_back(octave);
  }
  return left;
}

TEST(BarMisfit, NoiseIsNotTakenForMisfitNorMisfitForNoise) {
  std::mt19937_64 random(3);
  constexpr int kDraws = 20000;
  for (const std::size_t shots : {2U, 10U}) {
    int of_noise = 0;
    for (int draw = 0; draw < kDraws; ++draw) {
      of_noise += common_misfit(drawn(shots, 0.0, random), shots) ? 1 : 0;
    }
    // Five octaves of one in ten thousand: 10 expected; 25 would come once in 20 000 times.
    EXPECT_LT(of_noise, 25) << shots;
  }
  const auto misfit = common_misfit(drawn(10, 20.0, random), 10);
  ASSERT_TRUE(misfit.has_value());
  EXPECT_NEAR(misfit->power, 21.0, 7.0);
}

TEST(BarMisfit, OfOneShotNothingIsSaid) {
  std::mt19937_64 random(3);
  OctaveLeft octave;
  octave.numbers = octave.count_as = 12.0;
  octave.of_all = octave.in_common = 30.0;
  EXPECT_FALSE(common_misfit({octave}, 1).has_value());
}

}  // namespace
}  // namespace kolsky

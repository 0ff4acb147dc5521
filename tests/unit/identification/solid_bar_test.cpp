// Records of a bar with lateral inertia, made by axisymmetric elements that know no wave theory.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "processing/identification/bar_fit.hpp"
#include "tests/generators/solid_bar_shots.hpp"

namespace kolsky {
namespace {

/// Square of the parameters' distances from the truth in stated deviations, added up.
double off_in_deviations(const BarFit& fit, const std::array<double, 3>& truth) {
  double squares = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double z = (fit.parameters[i].value - truth[i]) / fit.parameters[i].sd;
    EXPECT_LT(std::abs(z), 4.0) << fit.parameters[i].name;
    squares += z * z;
  }
  return squares;
}

// What a model lacks is the same in every shot, so that ten of them do not make it less: of what
// noise says each deviation has grown by more than Birge's ratio, the root of the reduced chi2
// (Phys. Rev. 40 (1932) 207), which takes what is left for ten shots' independent scatter.
void expect_no_trust(const BarFit& wrong, const BarFit& right) {
  ASSERT_TRUE(wrong.misfit.has_value());
  EXPECT_GT(wrong.misfit->power, 10.0 * wrong.chi2_reduced * 0.5);
  for (std::size_t i = 0; i < wrong.parameters.size(); ++i) {
    EXPECT_GT(wrong.parameters[i].sd, 1.5 * std::sqrt(wrong.chi2_reduced) * right.parameters[i].sd)
        << wrong.parameters[i].name;
  }
}

TEST(SolidBar, MaterialIsFoundAsWellAsTheRecordsAllow) {
  const testing::SolidBarShots shots(testing::kTable4[0]);
  const testing::SolidBarShots::Tolerances tolerances;
  const auto bound = shots.bound(tolerances);
  constexpr int kRepeats = 4;
  std::mt19937_64 random(1);
  double squares = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    BarData data(shots.draw(tolerances, random), 0.0);
    const BarFit exact = fit_bar(data, {.waves = WaveTheory::exact});
    EXPECT_LT(exact.chi2_reduced, 1.1);
    squares += off_in_deviations(exact, shots.truth());
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_LT(exact.parameters[i].sd / shots.truth()[i], 1.3 * bound[i])
          << exact.parameters[i].name;
      EXPECT_GT(exact.parameters[i].sd / shots.truth()[i], 0.9 * bound[i])
          << exact.parameters[i].name;
    }
    EXPECT_FALSE(exact.misfit.has_value());
    if (repeat == 0) {
      // The paper's elementary waves on the same records: E1 about 1 % low.
      const BarFit elementary = fit_bar(data, {.waves = WaveTheory::elementary});
      EXPECT_LT(elementary.parameters[0].value, 0.996 * shots.truth()[0]);
      EXPECT_GT(elementary.chi2_reduced, 1.3);
      expect_no_trust(elementary, exact);
    }
  }
  // Chi square of 12, at one in a thousand.
  EXPECT_LT(squares, 32.9);
}

// More repeats, and bounds, by identify_exact.
TEST(SolidBar, EveryRowOfTable4InWhiteAndInSlowNoise) {
  const testing::SolidBarShots::Tolerances tolerances;
  double squares = 0.0;
  for (std::size_t row = 1; row < testing::kTable4.size(); ++row) {
    SCOPED_TRACE(testing::kTable4[row].source);
    const testing::SolidBarShots shots(testing::kTable4[row]);
    std::mt19937_64 random(row);
    for (const auto colour : {testing::NoiseColour::white, testing::NoiseColour::pink}) {
      BarData data(shots.draw(tolerances, random, colour), 0.0);
      squares += off_in_deviations(fit_bar(data, {.waves = WaveTheory::exact}), shots.truth());
    }
  }
  // Chi square of 18, at one in a thousand.
  EXPECT_LT(squares, 42.3);
}

}  // namespace
}  // namespace kolsky

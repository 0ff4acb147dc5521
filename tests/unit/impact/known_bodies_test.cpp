#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/generators/known_balls.hpp"
#include "tests/unit/impact/fine_meshes.hpp"

namespace kolsky::testing {
namespace {

TEST(BreathingSphere, HasItsFrequency) {
  const double coarse_Hz = breathing_frequency_Hz(512);
  const double fine_Hz = breathing_frequency_Hz(2048);
  RecordProperty("fine_mHz", static_cast<int>(1e3 * fine_Hz));
  EXPECT_NEAR(fine_Hz, kBreathing_Hz, 2e-4 * kBreathing_Hz);
  // Second order: a quarter of the error on a mesh twice as fine, or what is left is past telling.
  EXPECT_LT(std::abs(fine_Hz - kBreathing_Hz), 0.4 * std::abs(coarse_Hz - kBreathing_Hz) + 0.3);
}

TEST(HertzImpact, IsApproachedAsThePatchShrinks) {
  // T/T_H = 1 - c a/R: two patches extrapolate to none.
  const bool fine = fine_meshes();
  const HertzRun large = hertz(2.0, fine ? 8192 : 4096);
  const HertzRun small = fine ? hertz(0.5, 32768) : hertz(0.8, 8192);
  const double slope = (large.ratio - small.ratio) / (large.patch - small.patch);
  EXPECT_NEAR(small.ratio - slope * small.patch, 1.0, fine ? 0.005 : 0.02)
      << small.ratio << " " << large.ratio;
  EXPECT_NEAR(slope, -0.29, 0.08);
  const double by_patch = (large.peak - small.peak) / (large.patch - small.patch);
  const double peak = small.peak - by_patch * small.patch;
  std::printf("a/R %.3f and %.3f: force over Hertz's %.4f, %.4f, to none %.4f; radius %.3f, %.3f\n",
              large.patch, small.patch, large.peak, small.peak, peak, large.radius, small.radius);
  EXPECT_NEAR(peak, 1.0, 0.02);
  // To a third of an element's width, a seventh of these patches.
  EXPECT_NEAR(large.radius, 1.0, 0.05);
  EXPECT_NEAR(small.radius, 1.0, 0.05);
  // What does not come back rings in the sphere.
  EXPECT_NEAR(small.impulse, 1.0, 2e-3);
}

}  // namespace
}  // namespace kolsky::testing

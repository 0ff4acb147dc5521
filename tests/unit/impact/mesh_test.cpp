#include "processing/impact/mesh.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/impact/body.hpp"
#include "processing/impact/contact.hpp"

namespace kolsky::impact {
namespace {

constexpr std::array kTwoPiece = {0.03565, 0.0427};

TEST(BallMesh, HasAboutTheElementsAskedForAndFourRingsInTheCover) {
  for (const std::size_t wanted : {256U, 512U, 1000U, 2048U, 8192U}) {
    const Mesh mesh = ball_mesh(kTwoPiece, wanted);
    EXPECT_NEAR(static_cast<double>(mesh.elements()), static_cast<double>(wanted),
                0.1 * static_cast<double>(wanted));
    EXPECT_GE(mesh.regions.back().rows, 4U);
    EXPECT_EQ(mesh.regions.back().solid, 1U);
  }
}

TEST(BallMesh, WeighsWhatTheSphereWeighs) {
  const Body ball(ball_mesh(kTwoPiece, 512),
                  {elastic_solid(1140.0, 1e8, 0.3), elastic_solid(960.0, 1e8, 0.3)});
  const auto sphere = [](double d) { return std::numbers::pi / 6.0 * d * d * d; };
  const double core = sphere(0.03565);
  const double mass = 1140.0 * core + 960.0 * (sphere(0.0427) - core);
  EXPECT_NEAR(ball.mass_kg(), mass, 2e-4 * mass);
}

TEST(BallMesh, TiesJoinPlacesAndTheSurfaceGoesFromPoleToPole) {
  const Mesh mesh = ball_mesh(kTwoPiece, 512);
  EXPECT_EQ(mesh.ties.size(), 4U * 8U + 1U);
  for (const Tie& tie : mesh.ties) {
    EXPECT_NEAR(mesh.R_m[tie.a], mesh.R_m[tie.b], 1e-15);
    EXPECT_NEAR(mesh.Z_m[tie.a], mesh.Z_m[tie.b], 1e-15);
  }
  EXPECT_NEAR(mesh.Z_m[mesh.surface.front()], 0.0, 1e-15);
  EXPECT_NEAR(mesh.Z_m[mesh.surface.back()], 0.0427, 1e-4);
  for (const std::size_t node : mesh.axis) {
    EXPECT_EQ(mesh.R_m[node], 0.0);
  }
}

TEST(BallMesh, TakesAnyNumberOfLayers) {
  constexpr std::array kFour = {0.020, 0.030, 0.038, 0.0427};
  const Mesh mesh = ball_mesh(kFour, 4000);
  ASSERT_EQ(mesh.regions.size(), 5U);
  for (std::size_t layer = 1; layer < 4; ++layer) {
    EXPECT_GE(mesh.regions[layer + 1].rows, 4U);
  }
  constexpr std::array kOne = {0.0427};
  EXPECT_EQ(ball_mesh(kOne, 512).elements(), 512U);
}

TEST(BallMesh, RefusesTooFewElementsForItsLayers) {
  constexpr std::array kFour = {0.020, 0.030, 0.038, 0.0427};
  EXPECT_THROW((void)ball_mesh(kFour, 300), InputError);
}

TEST(BallMesh, OneLimitHoldsForEveryNumberFromItOn) {
  EXPECT_EQ(least_elements(2), 170U);
  for (std::size_t elements = least_elements(2); elements < 600; ++elements) {
    EXPECT_NO_THROW((void)ball_mesh(kTwoPiece, elements)) << elements;
  }
  EXPECT_THROW((void)ball_mesh(kTwoPiece, least_elements(2) - 1), InputError);
}

TEST(CoveredShare, IsTheArcThatLiesOnTheDisc) {
  EXPECT_EQ(covered_share(0.012, 0.0135, 0.0), 1.0);
  EXPECT_EQ(covered_share(0.014, 0.0135, 0.0), 0.0);
  EXPECT_EQ(covered_share(0.1, 0.0, 0.5), 1.0);  // an endless plane
  EXPECT_EQ(covered_share(0.0124, 0.0135, 0.001), 1.0);
  // Counted round the circle.
  const double r = 0.0130;
  int inside = 0;
  constexpr int kCount = 200000;
  for (int i = 0; i < kCount; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kCount;
    inside += std::hypot(r * std::cos(angle) - 0.001, r * std::sin(angle)) < 0.0135 ? 1 : 0;
  }
  EXPECT_NEAR(covered_share(r, 0.0135, 0.001), static_cast<double>(inside) / kCount, 1e-4);
}

TEST(SupportOf, IsThePenaltysWhereTheCircleLiesOnTheDisc) {
  const Edge edge{0.0135, 0.004, 345e6};
  for (const double r_m : {0.001, 0.0095}) {
    EXPECT_EQ(support_of(r_m, edge, 1.7e13).stiffness_Pa_per_m, 1.7e13);
    EXPECT_EQ(support_of(r_m, edge, 1.7e13).slope_Pa_per_m2, 0.0);
  }
  EXPECT_EQ(support_of(0.018, edge, 1.7e13).stiffness_Pa_per_m, 0.0);
}

TEST(SupportOf, YieldsByTheOverhangWhateverThePenalty) {
  const Edge edge{0.0135, 0.004, 345e6};
  double before = 1e300;
  for (const double r_m : {0.0097, 0.011, 0.0125, 0.015, 0.0174}) {
    const double s = covered_share(r_m, edge.disc_m, edge.offset_m);
    const double expected = s / (1.0 - s) * edge.modulus_Pa / (r_m - 0.0095);
    const double hard = support_of(r_m, edge, 1e20).stiffness_Pa_per_m;
    EXPECT_NEAR(hard, expected, 1e-4 * expected) << r_m;
    const double soft = support_of(r_m, edge, 1e12).stiffness_Pa_per_m;
    EXPECT_LT(soft, before);
    // Its slope is that of its stiffness.
    constexpr double kStep_m = 1e-9;
    const double slope = (support_of(r_m + kStep_m, edge, 1e12).stiffness_Pa_per_m -
                          support_of(r_m - kStep_m, edge, 1e12).stiffness_Pa_per_m) /
                         (2.0 * kStep_m);
    EXPECT_NEAR(support_of(r_m, edge, 1e12).slope_Pa_per_m2, slope, 1e-5 * std::abs(slope)) << r_m;
    before = soft;
  }
}

}  // namespace
}  // namespace kolsky::impact

#include "processing/models/exact_waves.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "processing/waves/pochhammer_chree.hpp"

namespace kolsky {
namespace {

// The table is of one complex number alone; the root finder knows bar, material and frequency.
TEST(ExactWaves, GiveWhatTheRootFinderGivesForAViscoelasticBar) {
  const double density_kg_m3 = 1180.0;
  const double radius_m = 0.010;
  const double poisson_ratio = 0.36;
  const ThreeElementSolid pmma(5.66e9, 37.0e9, 1.81e6);
  std::vector<Complex> path;
  for (double f = 20.0; f <= 80e3; f += 200.0) {
    path.emplace_back(3000.0, 2.0 * std::numbers::pi * f);
  }
  const auto modes = PochhammerChree(density_kg_m3, poisson_ratio, radius_m, pmma).along(path);
  const ExactWaves table(poisson_ratio);
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Complex elementary = path[k] * std::sqrt(density_kg_m3 * pmma.at(path[k]));
    const Complex scaled = elementary * radius_m;
    const auto ratios = table.at(scaled * scaled);
    const Complex gamma = elementary * std::sqrt(ratios.gamma_squared);
    EXPECT_LT(std::abs(gamma / modes[k].gamma - 1.0), 1e-8) << "at " << path[k];
    EXPECT_LT(std::abs(ratios.surface_over_mean - 1.0 / modes[k].mean_over_surface), 1e-7);
  }
}

TEST(ExactWaves, AreElementaryInAThinBar) {
  const ExactWaves table(0.3);
  const auto ratios = table.at({0.0, 0.0});
  EXPECT_NEAR(std::abs(ratios.gamma_squared - 1.0), 0.0, 1e-9);
  EXPECT_NEAR(std::abs(ratios.surface_over_mean - 1.0), 0.0, 1e-9);
}

}  // namespace
}  // namespace kolsky

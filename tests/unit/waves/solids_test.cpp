#include "processing/waves/solids.hpp"
#include "tests/unit/base/solid_material.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace kolsky {
namespace {

TEST(Solids, SlopesAreThoseOfTheCompliance) {
  constexpr double kStep = 1e-5;
  const std::vector<Complex> path = {{300.0, 0.0}, {300.0, 6e3}, {300.0, 3e5}};
  const std::vector<std::pair<SolidKind, std::vector<double>>> solids = {
      {SolidKind::three_element, {5.7e9, 37e9, 1.8e6}},
      {SolidKind::four_element_fluid, {5.7e9, 4e8, 37e9, 1.8e6}},
      {SolidKind::two_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7}},
      {SolidKind::three_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7, 50e9, 1e5}},
      {SolidKind::four_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7, 50e9, 1e5, 70e9, 5e5}},
      {SolidKind::fractional, {5.7e9, 37e9, 1.8e6, 0.7}}};
  for (const auto& [kind, parameters] : solids) {
    const auto slopes = log_slopes(kind, parameters, path);
    ASSERT_EQ(slopes.size(), parameters.size());
    for (std::size_t m = 0; m < parameters.size(); ++m) {
      const auto moved = [&](double step) {
        auto p = parameters;
        p[m] *= std::exp(step);
        return make_solid(kind, p);
      };
      for (std::size_t k = 0; k < path.size(); ++k) {
        const Complex up = std::log(moved(kStep)->at(path[k]));
        const Complex down = std::log(moved(-kStep)->at(path[k]));
        EXPECT_NEAR(std::abs(slopes[m][k] - (up - down) / (2.0 * kStep)), 0.0, 1e-9)
            << name_of(kind) << " " << m << " " << k;
      }
    }
  }
}

TEST(Solids, KelvinBranchesAreCountedUpToFour) {
  EXPECT_EQ(kelvin_branches(SolidKind::three_element), 1U);
  EXPECT_EQ(kelvin_branches(SolidKind::four_kelvin), 4U);
  EXPECT_EQ(kelvin_branches(SolidKind::fractional), 0U);
  EXPECT_EQ(one_branch_more(SolidKind::three_element), SolidKind::two_kelvin);
  EXPECT_EQ(one_branch_more(SolidKind::three_kelvin), SolidKind::four_kelvin);
  EXPECT_FALSE(one_branch_more(SolidKind::four_kelvin));
  EXPECT_FALSE(one_branch_more(SolidKind::four_element_fluid));
}

/// As processing/base/solid_kind.hpp writes them.
TEST(Solids, AMaterialIsCarriedByItsOwnFamily) {
  const Complex s(300.0, 6e4);
  const auto of = [&](SolidKind solid, const std::vector<double>& values) {
    return compliance_of(Bar{}, testing::material_of(solid, values))->at(s);
  };
  const auto kelvin = [&](double E, double eta) { return 1.0 / (E + s * eta); };
  const auto expect_near = [](Complex J, Complex wanted) {
    EXPECT_LT(std::abs(J - wanted), 1e-14 * std::abs(wanted));
  };
  expect_near(of(SolidKind::three_element, {5.7e9, 37e9, 1.8e6}),
              1.0 / 5.7e9 + kelvin(37e9, 1.8e6));
  expect_near(of(SolidKind::four_element_fluid, {5.7e9, 4e8, 37e9, 1.8e6}),
              1.0 / 5.7e9 + 1.0 / (s * 4e8) + kelvin(37e9, 1.8e6));
  expect_near(of(SolidKind::two_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7}),
              1.0 / 5.7e9 + kelvin(37e9, 1.8e6) + kelvin(60e9, 3e7));
  expect_near(of(SolidKind::three_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7, 50e9, 1e5}),
              1.0 / 5.7e9 + kelvin(37e9, 1.8e6) + kelvin(60e9, 3e7) + kelvin(50e9, 1e5));
  expect_near(of(SolidKind::four_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7, 50e9, 1e5, 70e9, 5e5}),
              1.0 / 5.7e9 + kelvin(37e9, 1.8e6) + kelvin(60e9, 3e7) + kelvin(50e9, 1e5) +
                  kelvin(70e9, 5e5));
  expect_near(of(SolidKind::fractional, {5.7e9, 37e9, 1.8e6, 0.7}),
              1.0 / 5.7e9 + 1.0 / (37e9 * (1.0 + std::pow(s * 1.8e6 / 37e9, 0.7))));
}

}  // namespace
}  // namespace kolsky

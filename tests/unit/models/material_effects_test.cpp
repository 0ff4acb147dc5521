#include "processing/models/material_effects.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>
#include <vector>

#include "processing/base/error.hpp"
#include "processing/models/scene.hpp"
#include "tests/unit/base/solid_material.hpp"

namespace kolsky {
namespace {

using testing::material_of;

Material two_kelvin() {
  return material_of(SolidKind::two_kelvin, {5.7e9, 40e9, 1.9e6, 160e9, 5e7});
}

/// The bar's J as a model's effects make it.
Complex by_effects(const Material& material, Complex s) {
  Bench bench;
  bench.input = Bar{};
  const std::vector<Complex> path{s};
  const ShotFacts facts;
  Scene scene(bench, facts, path);
  const Material three = three_elements_of(material);
  use_named("three-element-bar").effect->apply(scene, values_of(three.parameters), 0);
  if (const auto further = further_effect(material, "")) {
    std::vector<double> values;
    for (const ModelValue& value : further->values) {
      values.push_back(value.value);
      EXPECT_FALSE(value.free);
    }
    further->effect->apply(scene, values, 0);
  }
  return scene.bars[0].solid.compliance(s, 0);
}

TEST(MaterialEffects, HaveTheMaterialsComplianceExactly) {
  for (const Material& material :
       {paper_pmma(), two_kelvin(),
        material_of(SolidKind::four_element_fluid, {5.7e9, 4e8, 37e9, 1.8e6}),
        material_of(SolidKind::fractional, {5.7e9, 37e9, 1.8e6, 0.7})}) {
    for (const double frequency_Hz : {100.0, 3e3, 40e3}) {
      const Complex s(300.0, 2.0 * std::numbers::pi * frequency_Hz);
      const Complex J = compliance_of(material)->at(s);
      EXPECT_LT(std::abs(by_effects(material, s) - J), 1e-13 * std::abs(J))
          << name_of(material.solid);
    }
  }
}

/// With the rest known, what is left of a covariance is the inverse of its inverse's block.
TEST(MaterialEffects, LeaveOfTheDeviationsWhatIsLeftWhenTheRestIsKnown) {
  Material material = two_kelvin();
  Eigen::MatrixXd covariance(5, 5);
  for (Eigen::Index i = 0; i < 5; ++i) {
    for (Eigen::Index j = 0; j < 5; ++j) {
      covariance(i, j) = (i == j ? 2e-4 : 1.5e-4) *
                         material.parameters[static_cast<std::size_t>(i)] *
                         material.parameters[static_cast<std::size_t>(j)];
    }
  }
  material.covariance.emplace(covariance.data(), covariance.data() + covariance.size());
  const Eigen::MatrixXd left = covariance.inverse().topLeftCorner(3, 3).inverse();
  const Material three = three_elements_of(material);
  ASSERT_EQ(three.solid, SolidKind::three_element);
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double sd = three.parameters[static_cast<std::size_t>(i)].sd;
    EXPECT_NEAR(sd, std::sqrt(left(i, i)), 1e-6 * sd);
    for (Eigen::Index j = 0; j < 3; ++j) {
      EXPECT_NEAR(three.covariance->at(static_cast<std::size_t>(3 * i + j)) / left(i, j), 1.0,
                  1e-6);
    }
  }
}

TEST(MaterialEffects, RefuseWhatNoEffectIs) {
  const auto place_refused = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const InputError& error) {
      return error.place();
    }
    return "nothing";
  };
  const Material three_branches =
      material_of(SolidKind::three_kelvin, {5.7e9, 37e9, 1.8e6, 60e9, 3e7, 50e9, 1e5});
  EXPECT_EQ(place_refused([&] { (void)further_effect(three_branches, ""); }), "solid");
  const Material branch = material_of(SolidKind::fractional, {5.7e9, 37e9, 1.8e6, 0.7});
  EXPECT_EQ(place_refused([&] { (void)further_effect(branch, "core-"); }), "solid");
  // A branch slower than the effect goes.
  const Material slow = material_of(SolidKind::two_kelvin, {5.7e9, 40e9, 1.9e6, 160e9, 5e11});
  EXPECT_EQ(place_refused([&] { (void)further_effect(slow, ""); }), "solid");
  Bench mixed;
  mixed.output = mixed.input;
  mixed.output->youngs_modulus_Pa = Measured{113e9};
  const auto further = further_effect(two_kelvin(), "");
  EXPECT_EQ(place_refused([&] { require_for_all_bars(*further, two_kelvin(), mixed); }), "solid");
  mixed.output->youngs_modulus_Pa.reset();
  EXPECT_EQ(place_refused([&] { require_for_all_bars(*further, two_kelvin(), mixed); }), "nothing");
}

TEST(MaterialEffects, StandBehindTheirThreeElements) {
  Model model = paper_model(BenchKind::shpb, false);
  add_behind("three-element-bar", *further_effect(two_kelvin(), ""), model);
  ASSERT_GE(model.effects.size(), 2U);
  EXPECT_EQ(model.effects[0].id(), "three-element-bar");
  EXPECT_EQ(model.effects[1].id(), "second-relaxation");
  EXPECT_DOUBLE_EQ(model.effects[1].values[0].value, 1.0 / 160e9);
  EXPECT_DOUBLE_EQ(model.effects[1].values[1].value, 5e7 / 160e9);
}

}  // namespace
}  // namespace kolsky

#include "processing/base/material.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

std::string place_refused(const Material& material) {
  try {
    check(material);
  } catch (const InputError& error) {
    return error.place();
  }
  return "nothing";
}

Material solid(double density_kg_m3, double poisson_ratio, double E1_Pa, double E2_Pa,
               double eta2_Pa_s) {
  return three_element_material({density_kg_m3}, {poisson_ratio}, {E1_Pa}, {E2_Pa}, {eta2_Pa_s},
                                "");
}

Material two_kelvin() {
  Material material = paper_pmma();
  material.solid = SolidKind::two_kelvin;
  material.parameters = {{5.7e9}, {40e9}, {1.9e6}, {160e9}, {5e7}};
  return material;
}

Measured& number_of(Material& material, std::size_t i) {
  return i == 0   ? material.density_kg_m3
         : i == 1 ? material.poisson_ratio
                  : material.parameters.at(i - 2);
}

// Every solid that the paper tabulates (Table 4, core and cover).
TEST(Material, ThePapersAreTaken) {
  EXPECT_EQ(place_refused(paper_pmma()), "nothing");
  EXPECT_EQ(place_refused(solid(1183, 0.365, 5.25e9, 16.9e9, 2.13e6)), "nothing");
  EXPECT_EQ(place_refused(solid(1183, 0.365, 5.78e9, 72.3e9, 4.75e6)), "nothing");
  EXPECT_EQ(place_refused(solid(1190, 0.38, 5.99e9, 28.5e9, 0.68e6)), "nothing");
  EXPECT_EQ(place_refused(solid(1140, 0.376, 121e6, 143e6, 2860)), "nothing");
  EXPECT_EQ(place_refused(solid(960, 0.319, 987e6, 452e6, 6020)), "nothing");
}

TEST(Material, ThePapersPmmaIsItsFirstRow) {
  const Material pmma = paper_pmma();
  EXPECT_EQ(pmma.E1_Pa(), 5.66e9);
  EXPECT_EQ(pmma.E2_Pa(), 37.0e9);
  EXPECT_EQ(pmma.eta2_Pa_s(), 1.81e6);
  EXPECT_EQ(pmma.poisson_ratio, 0.36);
  EXPECT_EQ(pmma.density_kg_m3, 1180.0);
}

TEST(Material, RefusesEveryValueThatIsNone) {
  for (const Material& good : {paper_pmma(), two_kelvin()}) {
    std::vector<std::string> keys = {"density_kg_m3", "poisson_ratio"};
    for (const SolidParameter& parameter : parameters_of(good.solid)) {
      keys.push_back(parameter.name);
    }
    for (std::size_t i = 0; i < keys.size(); ++i) {
      for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -1.0,
                               std::numeric_limits<double>::infinity()}) {
        Material material = good;
        number_of(material, i).value = bad;
        EXPECT_EQ(place_refused(material), keys[i]);
        material = good;
        number_of(material, i).sd = bad;
        EXPECT_EQ(place_refused(material), keys[i] + "_sd");
      }
    }
  }
}

TEST(Material, EveryFamilyIsTakenWithItsOwnNumbers) {
  EXPECT_EQ(place_refused(two_kelvin()), "nothing");
  Material material = two_kelvin();
  material.parameters.pop_back();
  EXPECT_EQ(place_refused(material), "solid");
  material = two_kelvin();
  material.parameters[4].value = 1e-8 * material.parameters[3];
  EXPECT_EQ(place_refused(material), "eta3_Pa_s");
  material = two_kelvin();
  material.covariance.emplace(9, 0.0);
  EXPECT_EQ(place_refused(material), "covariance");
  material.covariance.emplace(25, 0.0);
  EXPECT_EQ(place_refused(material), "nothing");
  material.solid = SolidKind::fractional;
  material.covariance.reset();
  material.parameters = {{5.7e9}, {40e9}, {1.9e6}, {0.8}};
  EXPECT_EQ(place_refused(material), "nothing");
  material.parameters[3].value = 1.1;
  EXPECT_EQ(place_refused(material), "beta");
  // A dashpot in line has no spring beside it, and with it no retardation time.
  material.solid = SolidKind::four_element_fluid;
  material.parameters = {{5.7e9}, {4e12}, {40e9}, {1.9e6}};
  EXPECT_EQ(place_refused(material), "nothing");
}

TEST(Material, HasNoThreeElementsInAnotherFamily) {
  EXPECT_EQ(two_kelvin().E1_Pa(), 5.7e9);
  EXPECT_THROW((void)two_kelvin().E2_Pa(), InputError);
  EXPECT_THROW((void)two_kelvin().eta2_Pa_s(), InputError);
}

TEST(Material, RelaxesToAllItsSpringsInLine) {
  EXPECT_DOUBLE_EQ(relaxed_modulus_Pa(paper_pmma()), 1.0 / (1.0 / 5.66e9 + 1.0 / 37.0e9));
  EXPECT_DOUBLE_EQ(relaxed_modulus_Pa(two_kelvin()),
                   1.0 / (1.0 / 5.7e9 + 1.0 / 40e9 + 1.0 / 160e9));
}

}  // namespace
}  // namespace kolsky

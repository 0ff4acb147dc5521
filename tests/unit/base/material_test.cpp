#include "processing/base/material.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

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
  return {{density_kg_m3, 0.0}, {poisson_ratio, 0.0}, {E1_Pa, 0.0},
          {E2_Pa, 0.0},         {eta2_Pa_s, 0.0},     ""};
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
  EXPECT_EQ(pmma.E1_Pa, 5.66e9);
  EXPECT_EQ(pmma.E2_Pa, 37.0e9);
  EXPECT_EQ(pmma.eta2_Pa_s, 1.81e6);
  EXPECT_EQ(pmma.poisson_ratio, 0.36);
  EXPECT_EQ(pmma.density_kg_m3, 1180.0);
}

TEST(Material, RefusesEveryValueThatIsNone) {
  constexpr std::array kKeys{"density_kg_m3", "poisson_ratio", "E1_Pa", "E2_Pa", "eta2_Pa_s"};
  constexpr std::array kMembers{&Material::density_kg_m3, &Material::poisson_ratio,
                                &Material::E1_Pa, &Material::E2_Pa, &Material::eta2_Pa_s};
  for (std::size_t i = 0; i < kKeys.size(); ++i) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -1.0,
                             std::numeric_limits<double>::infinity()}) {
      Material material = paper_pmma();
      (material.*kMembers[i]).value = bad;
      EXPECT_EQ(place_refused(material), kKeys[i]);
      material = paper_pmma();
      (material.*kMembers[i]).sd = bad;
      EXPECT_EQ(place_refused(material), std::string(kKeys[i]) + "_sd");
    }
  }
}

}  // namespace
}  // namespace kolsky

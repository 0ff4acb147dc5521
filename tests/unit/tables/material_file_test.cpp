#include "drivers/files/settings/material_file.hpp"

#include <gtest/gtest.h>

#include "tests/scratch_folder.hpp"
#include "tests/unit/tables/refusal.hpp"

namespace kolsky {
namespace {

using testing::refusal_of;
using testing::ScratchFolder;

constexpr const char* kCore = R"(density_kg_m3 = 1140
poisson_ratio = 0.376
E1_Pa = 121e6
E2_Pa = 143e6
eta2_Pa_s = 2860
)";

void expect_same_number(const Measured& a, const Measured& b) {
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.sd, b.sd);
}

void expect_same(const Material& a, const Material& b) {
  expect_same_number(a.density_kg_m3, b.density_kg_m3);
  expect_same_number(a.poisson_ratio, b.poisson_ratio);
  EXPECT_EQ(a.solid, b.solid);
  ASSERT_EQ(a.parameters.size(), b.parameters.size());
  for (std::size_t i = 0; i < a.parameters.size(); ++i) {
    expect_same_number(a.parameters[i], b.parameters[i]);
  }
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.identified, b.identified);
}

TEST(MaterialFile, ReadsTheFiveKeys) {
  const Material core = parse_material(kCore, "m.toml");
  EXPECT_EQ(core.density_kg_m3, 1140.0);
  EXPECT_EQ(core.poisson_ratio, 0.376);
  EXPECT_EQ(core.E1_Pa(), 121e6);
  EXPECT_EQ(core.E2_Pa(), 143e6);
  EXPECT_EQ(core.eta2_Pa_s(), 2860.0);
  EXPECT_EQ(core.source, "");
}

TEST(MaterialFile, TakesWhatAnIdentificationFiles) {
  const ScratchFolder folder;
  const Material material = read_material(
      folder.write("m.toml", "source = \"ten shots\"\nE1_Pa_sd = 1e5\n" + std::string(kCore) +
                                 "covariance = [1, 0.1, 0, 0.1, 2, 0, 0, 0, 3]\n"
                                 "[identified]\nshots = 10\nband_limit_Hz = 6000\n"));
  ASSERT_TRUE(material.covariance);
  EXPECT_EQ((*material.covariance)[3], 0.1);
  ASSERT_TRUE(material.identified);
  EXPECT_EQ(material.identified->band_limit_Hz, 6000.0);
  EXPECT_FALSE(material.identified->temperature_K);
  EXPECT_EQ(material.source, "ten shots");
  EXPECT_EQ(material.E1_Pa().sd, 1e5);
}

TEST(MaterialFile, WhatIsWrittenReadsBackToTheBit) {
  expect_same(parse_material(format_material(paper_pmma()), "m.toml"), paper_pmma());
  Material odd;
  odd.density_kg_m3 = {1000.0 / 3.0, 1.0 / 3.0};
  odd.poisson_ratio = {0.1 + 0.2, 5e-324};
  odd.E1_Pa() = {1e15 / 7.0, 1e100};
  odd.E2_Pa() = {123456789.0, 0.0};
  odd.eta2_Pa_s() = {98765.4321e-1, 1e-300};
  odd.source = "a \"quoted\" \\ line\nand\ttab µ \x7F";
  expect_same(parse_material(format_material(odd), "m.toml"), odd);
  odd.covariance = {1.0 / 3.0, 0.1, 0.0, 0.1, 2.0 / 7.0, -1e-3, 0.0, -1e-3, 1e14 / 3.0};
  odd.identified = Material::Identified{94.39e3 / 7.0, 293.15};
  expect_same(parse_material(format_material(odd), "m.toml"), odd);
  const std::string with_more = format_material(odd, {10, "exact", 1.01, false});
  odd.identified->chi2_reduced = 1.01;
  odd.identified->passive = false;
  EXPECT_NE(with_more.find("dispersion = \"exact\""), std::string::npos);
  expect_same(parse_material(with_more, "m.toml"), odd);
  EXPECT_EQ(with_more.find("better_solid"), std::string::npos);
  const std::string outdone = format_material(odd, {10, "exact", 1.01, false, "a \"better\" one"});
  EXPECT_NE(outdone.find("better_solid = \"a \\\"better\\\" one\"\n"), std::string::npos)
      << outdone;
  expect_same(parse_material(outdone, "m.toml"), odd);
}

constexpr const char* kTwoKelvin = R"(solid = "two-kelvin"
density_kg_m3 = 1180
poisson_ratio = 0.36
E1_Pa = 5.7e9
E2_Pa = 40e9
eta2_Pa_s = 1.9e6
E3_Pa = 160e9
E3_Pa_sd = 2e9
eta3_Pa_s = 5e7
)";

TEST(MaterialFile, ReadsAnotherFamilyByItsParametersNames) {
  const Material bar = parse_material(kTwoKelvin, "m.toml");
  EXPECT_EQ(bar.solid, SolidKind::two_kelvin);
  EXPECT_EQ(values_of(bar.parameters), (std::vector<double>{5.7e9, 40e9, 1.9e6, 160e9, 5e7}));
  EXPECT_EQ(bar.parameters[3].sd, 2e9);
  EXPECT_EQ(parse_material("solid = \"three-element\"\n" + std::string(kCore), "m.toml").solid,
            SolidKind::three_element);
}

TEST(MaterialFile, EveryFamilyReadsBackToTheBit) {
  for (const SolidKind solid :
       {SolidKind::three_element, SolidKind::four_element_fluid, SolidKind::two_kelvin,
        SolidKind::three_kelvin, SolidKind::four_kelvin, SolidKind::fractional}) {
    Material material = paper_pmma();
    material.solid = solid;
    material.parameters.clear();
    const auto& family = parameters_of(solid);
    for (std::size_t i = 0; i < family.size(); ++i) {
      const double value = family[i].is == SolidParameter::Is::modulus     ? 1e10 / 3.0
                           : family[i].is == SolidParameter::Is::viscosity ? 1e6 / 3.0
                                                                           : 0.7;
      material.parameters.push_back({value, value / (7.0 + static_cast<double>(i))});
    }
    auto& covariance = material.covariance.emplace(family.size() * family.size(), 0.0);
    for (std::size_t i = 0; i < family.size(); ++i) {
      covariance[i * (family.size() + 1)] = 1.0 / (3.0 + static_cast<double>(i));
    }
    const std::string text = format_material(material);
    EXPECT_EQ(text.find("solid = ") == std::string::npos, solid == SolidKind::three_element);
    expect_same(parse_material(text, "m.toml"), material);
  }
}

TEST(MaterialFile, RefusesWhatIsNotOfItsFamily) {
  const auto refusal = [](const std::string& text) {
    return refusal_of([&] { (void)parse_material(text, "m.toml"); });
  };
  const auto with = [](std::string text, const std::string& what, const std::string& in_place) {
    return text.replace(text.find(what), what.size(), in_place);
  };
  EXPECT_EQ(refusal(std::string(kCore) + "E3_Pa = 1e9\n"),
            "m.toml:6: E3_Pa: is no parameter of a three-element solid; leave it out, or say which "
            "solid has it: solid = \"two-kelvin\"");
  EXPECT_EQ(refusal(with(kTwoKelvin, "two-kelvin", "burgers")),
            "m.toml:1: solid: \"burgers\" is not a family of solids; give three-element, "
            "four-element-fluid, two-kelvin, three-kelvin, four-kelvin or fractional");
  EXPECT_EQ(refusal(with(kTwoKelvin, "eta3_Pa_s = 5e7\n", "")),
            "m.toml: eta3_Pa_s: is missing; add it");
  EXPECT_EQ(refusal(std::string(kTwoKelvin) + "covariance = [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"),
            "m.toml:10: covariance: has 9 numbers; give 25, row by row, of E1_Pa, E2_Pa, "
            "eta2_Pa_s, E3_Pa and eta3_Pa_s");
  EXPECT_EQ(refusal(with(kTwoKelvin, "E3_Pa = 160e9", "E3_Pa = -160e9")).substr(0, 15),
            "m.toml:7: E3_Pa");
  EXPECT_EQ(refusal(with(kTwoKelvin, "5e7", "5")).substr(0, 19), "m.toml:9: eta3_Pa_s");
  const std::string branch = "solid = \"fractional\"\n" + std::string(kCore);
  EXPECT_EQ(refusal(branch + "beta = 1.2\n"),
            "m.toml:7: beta: 1.2 is outside 0.01 to 1; a solid that creeps has one from 0 to 1: "
            "file three elements in place of 1");
}

struct MaterialRefusal {
  const char* what;
  const char* with;
  const char* place;
  const char* mend;
};

class MaterialRefusals : public ::testing::TestWithParam<MaterialRefusal> {};

TEST_P(MaterialRefusals, NamesTheLineTheKeyAndTheMend) {
  std::string text = kCore;
  text.replace(text.find(GetParam().what), std::string(GetParam().what).size(), GetParam().with);
  const std::string line = refusal_of([&] { (void)parse_material(text, "m.toml"); });
  EXPECT_TRUE(line.starts_with("m.toml:" + std::string(GetParam().place) + ": ")) << line;
  EXPECT_NE(line.find(GetParam().mend), std::string::npos) << line;
}

INSTANTIATE_TEST_SUITE_P(
    Values, MaterialRefusals,
    ::testing::Values(
        MaterialRefusal{"1140", "1.14", "1: density_kg_m3", "kg/m3"},
        MaterialRefusal{"0.376", "37.6", "2: poisson_ratio", "ratio"},
        MaterialRefusal{"0.376", "-0.1", "2: poisson_ratio", "ratio"},
        MaterialRefusal{"121e6", "121", "3: E1_Pa", "pascals"},
        MaterialRefusal{"121e6", "-121e6", "3: E1_Pa", "pascals"},
        MaterialRefusal{"143e6", "0.143", "4: E2_Pa", "pascals"},
        MaterialRefusal{"2860", "2.86", "5: eta2_Pa_s", "2.86 kPa s is 2860"},
        MaterialRefusal{"2860", "0", "5: eta2_Pa_s", "pascal seconds"},
        MaterialRefusal{"2860", "2860\neta2_Pa_s_sd = -1", "6: eta2_Pa_s_sd", "standard deviation"},
        MaterialRefusal{"E1_Pa", "E1_MPa", "3: E1_MPa", "did you mean \"E1_Pa\"?"},
        MaterialRefusal{"eta2_Pa_s", "eta_Pa_s", "5: eta_Pa_s", "did you mean \"eta2_Pa_s\"?"},
        MaterialRefusal{"2860", "2860\n[sources]", "6: sources", "did you mean \"source\"?"}));

TEST(MaterialFile, NamesAMissingKey) {
  EXPECT_EQ(refusal_of([] { (void)parse_material("density_kg_m3 = 1140", "m.toml"); }),
            "m.toml: poisson_ratio: is missing; add it");
}

}  // namespace
}  // namespace kolsky

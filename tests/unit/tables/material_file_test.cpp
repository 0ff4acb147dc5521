#include "drivers/files/settings/material_file.hpp"

#include <gtest/gtest.h>

#include "tests/unit/tables/scratch_folder.hpp"

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
  expect_same_number(a.E1_Pa, b.E1_Pa);
  expect_same_number(a.E2_Pa, b.E2_Pa);
  expect_same_number(a.eta2_Pa_s, b.eta2_Pa_s);
  EXPECT_EQ(a.source, b.source);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.identified, b.identified);
}

TEST(MaterialFile, ReadsTheFiveKeys) {
  const Material core = parse_material(kCore, "m.toml");
  EXPECT_EQ(core.density_kg_m3, 1140.0);
  EXPECT_EQ(core.poisson_ratio, 0.376);
  EXPECT_EQ(core.E1_Pa, 121e6);
  EXPECT_EQ(core.E2_Pa, 143e6);
  EXPECT_EQ(core.eta2_Pa_s, 2860.0);
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
  EXPECT_EQ(material.E1_Pa.sd, 1e5);
}

TEST(MaterialFile, WhatIsWrittenReadsBackToTheBit) {
  expect_same(parse_material(format_material(paper_pmma()), "m.toml"), paper_pmma());
  Material odd;
  odd.density_kg_m3 = {1000.0 / 3.0, 1.0 / 3.0};
  odd.poisson_ratio = {0.1 + 0.2, 5e-324};
  odd.E1_Pa = {1e15 / 7.0, 1e100};
  odd.E2_Pa = {123456789.0, 0.0};
  odd.eta2_Pa_s = {98765.4321e-1, 1e-300};
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

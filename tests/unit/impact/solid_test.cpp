#include <gtest/gtest.h>

#include <cmath>

#include "processing/base/error.hpp"
#include "processing/impact/bench_impact.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace kolsky::impact {
namespace {

using kolsky::testing::paper_core;
using kolsky::testing::paper_cover;

// s times the transform of E(t) is 1/J(s): the definition of the two laws being one solid.
double carson_modulus(const RelaxationLaw& law, double s) {
  double modulus = law.relaxed_Pa;
  for (const MaxwellArm& arm : law.arms) {
    modulus += arm.modulus_Pa * s * arm.time_s / (1.0 + s * arm.time_s);
  }
  return modulus;
}

double compliance(const CreepLaw& creep, double s) {
  double J = creep.instantaneous_per_Pa;
  for (const KelvinUnit& unit : creep.units) {
    J += unit.compliance_per_Pa / (1.0 + s * unit.time_s);
  }
  return J;
}

double uniaxial_modulus(const Solid& solid, double s) {
  double G = solid.shear_relaxed_Pa;
  double K = solid.bulk_relaxed_Pa;
  for (const SolidArm& arm : solid.arms) {
    G += arm.shear_Pa * s * arm.time_s / (1.0 + s * arm.time_s);
    K += arm.bulk_Pa * s * arm.time_s / (1.0 + s * arm.time_s);
  }
  return 9.0 * K * G / (3.0 * K + G);
}

TEST(Relaxation, OfThreeElementsIsTheTextbooks) {
  const RelaxationLaw core = relaxation_of(creep_of(paper_core()));
  ASSERT_EQ(core.arms.size(), 1U);
  EXPECT_NEAR(core.relaxed_Pa, 121e6 * 143e6 / 264e6, 1.0);
  EXPECT_NEAR(core.arms[0].time_s, 2860.0 / 264e6, 1e-14);  // eta2/(E1 + E2), 10.83 us
  EXPECT_NEAR(core.instantaneous_Pa(), 121e6, 1.0);
  EXPECT_NEAR(relaxation_of(creep_of(paper_cover())).arms[0].time_s, 4.1835e-6, 1e-10);
}

TEST(Relaxation, OfAnyNumberOfUnitsIsTheSameSolid) {
  const CreepLaw creep{1.0 / 121e6,
                       {{7e-9, 2e-5}, {1e-9, 3e-4}, {4e-9, 2.2e-5}, {2e-10, 1e-7}, {5e-9, 0.1}}};
  const RelaxationLaw law = relaxation_of(creep);
  ASSERT_EQ(law.arms.size(), 5U);
  for (const double s : {0.1, 10.0, 1e3, 3e4, 5e4, 1e6, 1e9}) {
    EXPECT_NEAR(carson_modulus(law, s) * compliance(creep, s), 1.0, 1e-9) << s;
  }
}

TEST(Relaxation, ForgetsEmptyUnitsAndMergesEqualTimes) {
  EXPECT_TRUE(relaxation_of({1e-8, {{0.0, 1.0}}}).arms.empty());
  const RelaxationLaw law = relaxation_of({1e-8, {{2e-9, 1e-5}, {3e-9, 1e-5}}});
  ASSERT_EQ(law.arms.size(), 1U);
  EXPECT_NEAR(law.relaxed_Pa, 1.0 / 1.5e-8, 1e-3);
}

TEST(Reading, FullKeepsPoissonsRatioAndTheUniaxialLaw) {
  const Solid solid = solid_of(paper_cover(), Reading::full);
  const CreepLaw creep = creep_of(paper_cover());
  for (const double s : {1.0, 1e5, 1e7}) {
    EXPECT_NEAR(uniaxial_modulus(solid, s) * compliance(creep, s), 1.0, 1e-9);
  }
  EXPECT_NEAR(solid.bulk_relaxed_Pa / solid.shear_relaxed_Pa,
              2.0 * 1.319 / (3.0 * (1.0 - 2.0 * 0.319)), 1e-9);
}

TEST(Reading, ExactKeepsTheUniaxialLawWithAnElasticBulk) {
  const Solid solid = solid_of(paper_cover(), Reading::exact);
  const CreepLaw creep = creep_of(paper_cover());
  for (const double s : {1.0, 1e5, 3e5, 1e7}) {
    EXPECT_NEAR(uniaxial_modulus(solid, s) * compliance(creep, s), 1.0, 1e-9);
  }
  ASSERT_EQ(solid.arms.size(), 1U);
  EXPECT_EQ(solid.arms[0].bulk_Pa, 0.0);
  EXPECT_NEAR(solid.bulk_relaxed_Pa, 987e6 / (3.0 * 0.362), 1.0);
}

TEST(Reading, BulkEinfDropsTheCoversInstantaneousModulusTo781) {
  EXPECT_NEAR(instantaneous_modulus_Pa(solid_of(paper_cover(), Reading::bulk_Einf)), 781e6, 0.5e6);
  EXPECT_NEAR(relaxed_modulus_Pa(solid_of(paper_cover(), Reading::bulk_Einf)), 310.02e6, 0.01e6);
  EXPECT_NEAR(instantaneous_modulus_Pa(solid_of(paper_cover(), Reading::bulk_E1)), 987e6, 1e3);
}

TEST(Reading, NamesGoBothWays) {
  for (const char* name : {"full", "bulk-E1", "bulk-Einf", "exact"}) {
    EXPECT_EQ(name_of(reading_named(name, "x")), name);
  }
  EXPECT_THROW((void)reading_named("half", "--reading"), InputError);
}

TEST(Solid, SecondRelaxationAddsItsComplianceInTheReading) {
  const BallMaterial with{paper_core(), Reading::exact, 0.0, {1e-9, 1e-4}};
  const Solid solid = solid_of(with);
  ASSERT_EQ(solid.arms.size(), 2U);
  for (const double s : {1.0, 1e4, 1e6}) {
    const double J = compliance(creep_of(paper_core()), s) + 1e-9 / (1.0 + s * 1e-4);
    EXPECT_NEAR(uniaxial_modulus(solid, s) * J, 1.0, 1e-9);
  }
}

TEST(Solid, CarriesEveryKelvinBranchOfAMaterial) {
  Material material = paper_core();
  material.solid = SolidKind::three_kelvin;
  material.parameters = {{130e6}, {160e6}, {2500.0}, {900e6}, {9e4}, {2e9}, {2e3}};
  const Solid solid = solid_of(material, Reading::full);
  ASSERT_EQ(solid.arms.size(), 3U);
  for (const double s : {1.0, 1e3, 1e4, 1e5, 1e7}) {
    const double J =
        1.0 / 130e6 + 1.0 / (160e6 + s * 2500.0) + 1.0 / (900e6 + s * 9e4) + 1.0 / (2e9 + s * 2e3);
    EXPECT_NEAR(uniaxial_modulus(solid, s) * J, 1.0, 1e-9);
  }
}

TEST(Solid, RefusesMaterialsThatAreNoChainOfKelvinUnits) {
  Material material = paper_core();
  material.solid = SolidKind::fractional;
  material.parameters = {{130e6}, {160e6}, {2500.0}, {0.8}};
  try {
    (void)solid_of(material, Reading::full);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_EQ(error.place(), "solid");
    EXPECT_NE(std::string(error.what()).find("two-kelvin"), std::string::npos) << error.what();
  }
  material.solid = SolidKind::four_element_fluid;
  EXPECT_THROW((void)solid_of(material, Reading::full), InputError);
}

TEST(Solid, RefusesWhatIsNotPassive) {
  Material material = paper_core();
  material.eta2_Pa_s() = {-1.0};
  EXPECT_THROW((void)solid_of(material, Reading::full), InputError);
  material = paper_core();
  material.poisson_ratio = {0.5};
  EXPECT_THROW((void)solid_of(material, Reading::full), InputError);
  EXPECT_THROW((void)solid_of({paper_core(), Reading::full, 0.0, {-1e-9, 1e-4}}), InputError);
  EXPECT_THROW((void)solid_of({paper_core(), Reading::full, 0.0, {1e-9, 0.0}}), InputError);
  EXPECT_THROW((void)elastic_solid(1000.0, std::nan(""), 0.3), InputError);
}

}  // namespace
}  // namespace kolsky::impact

#include "processing/models/formula_strength.hpp"

#include <gtest/gtest.h>

#include "tests/unit/models/fitted_strength.hpp"

namespace kolsky {
namespace {

TEST(FormulaStrength, IsWhatTheFormulaGivesWithinDeviationsOrATenth) {
  EXPECT_TRUE(is_its_formula(fitted_strength("specimen-inertia", 0.95, 0.001)));
  EXPECT_TRUE(is_its_formula(fitted_strength("specimen-inertia", 1.2, 0.08)));
  EXPECT_FALSE(is_its_formula(fitted_strength("specimen-inertia", 1.2, 0.03)));
  EXPECT_FALSE(may_be_its_formula(fitted_strength("specimen-inertia", 1.2, 0.03)));
  EXPECT_FALSE(is_its_formula(fitted_strength("interface-friction", 1.0, 0.001)));
}

// Of a specimen that rubs, beside two effects that it has not.
TEST(FormulaStrength, KnownToAnEighthMayBeIt) {
  EXPECT_FALSE(is_its_formula(fitted_strength("specimen-inertia", 0.84, 0.098)));
  EXPECT_TRUE(may_be_its_formula(fitted_strength("specimen-inertia", 0.84, 0.098)));
  EXPECT_FALSE(may_be_its_formula(fitted_strength("radial-inertia", 0.1, 0.3)));
  EXPECT_FALSE(may_be_its_formula(fitted_strength("punching", 10.0, 3.1)));
}

// Waves across a section of the size filed; with a strength besides they did a quick relaxation's
// work.
TEST(FormulaStrength, AllowsWavesAcrossTheSectionByTheFormulaAlone) {
  EffectUse crossed = fitted_strength("radial-inertia", 1.58, 0.13);
  EXPECT_TRUE(allowed_by_formula(crossed));
  crossed.values[1].value = 1.0;
  EXPECT_FALSE(allowed_by_formula(crossed));
  crossed.values[0].value = 0.9;
  crossed.values[0].sd = 0.01;
  EXPECT_TRUE(allowed_by_formula(crossed));
  EXPECT_TRUE(allowed_by_formula(fitted_strength("interface-friction", 0.3, 0.01)));
}

}  // namespace
}  // namespace kolsky

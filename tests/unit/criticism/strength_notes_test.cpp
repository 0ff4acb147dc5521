#include "processing/criticism/verdict/strength_notes.hpp"

#include <gtest/gtest.h>

#include "tests/unit/models/fitted_strength.hpp"

namespace kolsky {
namespace {

TEST(StrengthNotes, SayWhereItIsNotWhatItsFormulaMakesIt) {
  const auto text = unlike_formula_text(fitted_strength("punching", 10.2, 1.8));
  ASSERT_TRUE(text);
  EXPECT_EQ(text->find("punching: s is 1 by its formula with the sizes filed, and 10.2 ± 1.8 here"),
            0U)
      << *text;
  EXPECT_TRUE(unlike_formula_text(fitted_strength("radial-inertia", 1.23, 0.023)));
  // Within its deviations, near enough, and of what no formula gives.
  EXPECT_FALSE(unlike_formula_text(fitted_strength("punching", 3.0, 0.8)));
  EXPECT_FALSE(unlike_formula_text(fitted_strength("radial-inertia", 1.05, 0.001)));
  EXPECT_FALSE(unlike_formula_text(fitted_strength("interface-friction", 0.3, 0.001)));
}

TEST(StrengthNotes, SayWhereARelaxationIsNoMoreThanItsBeginning) {
  EffectUse use = fitted_strength("specimen-second-relaxation", 4.8e-8, 1.6e-7);
  use.values[1].free = true;
  use.values[1].value = 1e-2;
  use.values[1].sd = 4e-2;
  EXPECT_TRUE(only_begins_text(use));
  use.values[1].sd = 1e-3;
  EXPECT_FALSE(only_begins_text(use));
  use.values[1].sd = 4e-2;
  use.values[0].sd = 1e-9;
  EXPECT_FALSE(only_begins_text(use));
  EXPECT_FALSE(only_begins_text(fitted_strength("interface-friction", 0.1, 1.0)));
}

}  // namespace
}  // namespace kolsky

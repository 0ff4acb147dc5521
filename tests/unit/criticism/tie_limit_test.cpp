#include <gtest/gtest.h>

#include "processing/criticism/verdict/choice.hpp"
#include "tests/unit/models/fitted_strength.hpp"

namespace kolsky {
namespace {

// A thick specimen of finite elements: what it takes to widen, and a bar of another length.
TEST(TieLimit, IsWiderForWhatAFormulaGivesThanForAFault) {
  const EffectUse length = fitted_strength("bar-length", -0.9e-4, 0.1e-4);
  const EffectUse widening = fitted_strength("radial-inertia", 0.48, 0.1);
  EXPECT_EQ(tie_limit(length, widening), 2.0 * kTie);
  EXPECT_EQ(tie_limit(widening, length), kTie);
}

TEST(TieLimit, IsThatOfAllForAnotherStrengthAndBesideAFormula) {
  const EffectUse length = fitted_strength("bar-length", -0.9e-4, 0.1e-4);
  EXPECT_EQ(tie_limit(length, fitted_strength("radial-inertia", 8.0, 0.5)), kTie);
  EXPECT_EQ(tie_limit(length, fitted_strength("interface-friction", 1.0, 0.1)), kTie);
  EXPECT_EQ(tie_limit(fitted_strength("specimen-inertia", 1.0, 0.1),
                      fitted_strength("radial-inertia", 1.0, 0.1)),
            kTie);
}

}  // namespace
}  // namespace kolsky

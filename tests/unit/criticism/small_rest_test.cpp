#include "processing/criticism/verdict/small_rest.hpp"

#include <gtest/gtest.h>

namespace kolsky {
namespace {

// Specimens of finite elements: its mass, a gauge that is off, and what no formula has.
const ClaimGains kWithGauge{{{"specimen-inertia", 2240.0}},
                            {{"amplitude-dependence", 19.2}, {"gauge-factor:o1", 2873.0}}};
const ClaimGains kThick{{{"specimen-inertia", 20548.0}, {"radial-inertia", 39.4}},
                        {{"bar-length", 84.9}}};

TEST(SmallRest, AThirdExplainsNextToNothingOfWhatTheOthersDo) {
  EXPECT_EQ(dwarfed(kWithGauge), "amplitude-dependence");
  EXPECT_EQ(dwarfed(kThick), "bar-length");
}

TEST(SmallRest, AThirdThatExplainsAFortiethIsNone) {
  ClaimGains gains = kWithGauge;
  gains.others["amplitude-dependence"] = 2240.0 / 40.0;
  EXPECT_FALSE(dwarfed(gains));
}

// Definitions that are exact leave nothing to others.
TEST(SmallRest, WithoutAFormulaNothingIsTooLittle) {
  const ClaimGains gains{
      {},
      {{"gauge-position:g1", 3701.0}, {"series-dashpot", 2148.0}, {"amplifier-bandwidth:g3", 1.0}}};
  EXPECT_FALSE(dwarfed(gains));
  EXPECT_EQ(small_rest(gains), 0.0);
  // A fit that lacks it came out the better one.
  EXPECT_FALSE(dwarfed({{}, {{"a", 9.0}, {"b", 8.0}, {"c", -0.1}}}));
}

TEST(SmallRest, OfOneClaimOrOfTwoThereIsNoThird) {
  EXPECT_FALSE(dwarfed({}));
  EXPECT_FALSE(dwarfed({{{"specimen-inertia", 9870.0}}, {}}));
  EXPECT_FALSE(dwarfed({{{"specimen-inertia", 9870.0}}, {{"gauge-factor:g4", 42.0}}}));
}

TEST(SmallRest, IsJudgedByTheLeastClaimButByTheGreatestFormula) {
  const ClaimGains gap{{{"specimen-inertia", 5644.0}}, {{"interface-gap", 133696.0}}};
  EXPECT_DOUBLE_EQ(small_rest(gap), kSmallRest * 5644.0);
  EXPECT_DOUBLE_EQ(small_rest({kThick.by_formula, {}}), 3.94);
}

// What is left may be all that a formula seems to explain.
TEST(SmallRest, MovesNoFormulaByMuch) {
  ClaimGains gains{kThick.by_formula, {}};
  gains.by_formula["radial-inertia"] = 5000.0;
  EXPECT_DOUBLE_EQ(small_rest(gains), kSmallRest * 20548.0);
  gains.by_formula["radial-inertia"] = 100.0;
  EXPECT_DOUBLE_EQ(small_rest(gains), 10.0);
}

// A hundredth of chi2 is a tenth of a strength.
TEST(SmallRest, MovesAStrengthByTheRootOfItsShare) {
  const SmallRest rest{{{{"specimen-inertia", 5000.0}}, {{"gauge-factor:o1", 200.0}}}, 50.0};
  EXPECT_DOUBLE_EQ(share_moved(rest, "specimen-inertia"), 0.1);
  EXPECT_DOUBLE_EQ(share_moved(rest, "gauge-factor:o1"), 0.5);
  EXPECT_EQ(share_moved(rest, "geometric-dispersion"), 0.0);
  EXPECT_EQ(share_moved(std::nullopt, "specimen-inertia"), 0.0);
}

TEST(SmallRest, IsToldWithWhatWouldTakeItUp) {
  const SmallRest rest{{{{"specimen-inertia", 3816.0}}, {{"baseline-drift:o3", 411623.0}}}, 34.4};
  const std::string text = small_rest_text(rest, "interface-friction");
  EXPECT_NE(text.find("0.9 % of what specimen-inertia explains"), std::string::npos) << text;
  EXPECT_NE(text.find("interface-friction would take up some of it"), std::string::npos) << text;
  EXPECT_EQ(small_rest_text(rest, "").find("would take up"), std::string::npos);
}

TEST(SmallRest, OfWhatWasSetAsideIsMeasuredByTheOthers) {
  EXPECT_NE(dwarfed_text(kThick, "bar-length").find("0.4 % of what specimen-inertia explains"),
            std::string::npos)
      << dwarfed_text(kThick, "bar-length");
}

}  // namespace
}  // namespace kolsky

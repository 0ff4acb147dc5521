#include "processing/criticism/waterfall/impact_waterfall.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/criticism/thrown_balls.hpp"

namespace kolsky {
namespace {

using testing::paper_with;
using testing::two_speeds;

Waterfall fall_of(const std::vector<Shot>& shots, const std::vector<std::string>& effects) {
  testing::ThrownBalls balls(shots);
  return waterfall(balls.study, lineage(paper_with({}), paper_with(effects), {}));
}

TEST(ImpactWaterfall, FallsToTheNoiseByWhatWasHidden) {
  testing::ImpactWishes own = two_speeds(41, 2);
  own.core_b = 0.9;
  const Waterfall fall = fall_of(testing::impact_shots(own), {"core-nonlinearity"});
  ASSERT_EQ(fall.steps.size(), 2U);
  EXPECT_EQ(fall.fold, "speeds");
  EXPECT_EQ(fall.folds, 2U);
  EXPECT_EQ(fall.shots, 4U);
  // 27 of 29 residuals; the noise by how two pairs of shots differ, known to 19 %.
  EXPECT_NEAR(fall.floor, 0.93, 0.35);
  EXPECT_GT(fall.steps[0].held_out, 3.0 * fall.floor);
  EXPECT_LT(fall.steps[1].held_out, 1.5 * fall.floor);
  EXPECT_GT(fall.closed(), 0.8);
  // The shares are by the noise alone: what repeats goes as the square of the rms that the speeds
  // show, and most of it is left by the linear ball at 51 m/s.
  const auto share = [&](std::size_t step) { return fall.steps[step].misfit.repeatable_share; };
  const auto noise_share = [&](std::size_t step) {
    return fall.steps[step].misfit.noise_floor_share;
  };
  const SpeedMisfit& fastest = fall.steps[0].speeds[1];
  EXPECT_GT(share(0) / noise_share(0),
            0.2 * std::pow(fastest.rms_percent / fastest.noise_percent, 2));
  EXPECT_GT(share(0), 4.0 * share(1));
  EXPECT_NEAR(fall.repeats / fall.signal, share(1), 1e-12);
  EXPECT_TRUE(fall.within_allowance);
  EXPECT_EQ(fall.steps[1].better, 2U);
  EXPECT_NEAR(fall.steps[1].gain / (4.0 * 29.0), fall.steps[0].held_out - fall.steps[1].held_out,
              0.2 * (fall.steps[0].held_out - fall.steps[1].held_out));
  // The error where the ball is struck hardest falls to what two codes differ by
  // (docs/methods/impact-trials.md).
  ASSERT_EQ(fall.steps[0].speeds.size(), 2U);
  EXPECT_NEAR(fall.steps[0].speeds[1].speed_m_per_s, 51.0, 1.0);
  EXPECT_GT(fall.steps[0].speeds[1].rms_percent, 1.0);
  EXPECT_LT(fall.steps[1].speeds[1].rms_percent, 0.5);
  EXPECT_NEAR(fall.steps[1].speeds[1].restitution_foretold,
              fall.steps[1].speeds[1].restitution_measured, 0.005);
  const MovedNumber& b = fall.steps[1].strengths.at(0);
  EXPECT_NEAR(b.value, 0.9, 3.0 * b.sd);
  EXPECT_LT(b.sd, 0.3);
}

TEST(ImpactWaterfall, CreditsAnEffectThatIsNotThereWithNothingAndHoldsOutShotsOfOneSpeed) {
  testing::ImpactWishes own = two_speeds(42, 3);
  own.speeds_m_per_s = {40.3};
  const Waterfall fall = fall_of(testing::impact_shots(own), {"bridge-nonlinearity"});
  ASSERT_EQ(fall.steps.size(), 2U);
  EXPECT_EQ(fall.fold, "shots");
  EXPECT_EQ(fall.folds, 3U);
  // A claim's square counts over kSolverDoubt.
  EXPECT_LT(fall.steps[1].gain / kSolverDoubt, 4.0);
  EXPECT_LT(fall.steps[0].held_out, 1.5 * fall.floor);
}

TEST(Lineage, AReadingChosenAnewIsAStepOfItsOwn) {
  const Model first = paper_with({});
  Model last = paper_with({"core-nonlinearity"});
  last.find("three-dimensional-reading")->values[0].value = 3.0;
  const auto steps = lineage(first, last, {});
  ASSERT_EQ(steps.size(), 3U);
  EXPECT_EQ(steps[1].effect, "three-dimensional-reading");
  EXPECT_EQ(steps[1].model.find("core-nonlinearity"), nullptr);
  EXPECT_EQ(steps[2].effect, "core-nonlinearity");
  EXPECT_EQ(steps[2].model.find("three-dimensional-reading")->values[0].value, 3.0);
}

}  // namespace
}  // namespace kolsky

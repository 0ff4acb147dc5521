#include <gtest/gtest.h>

#include "daemon/critic/shot_comparison.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "tests/unit/criticism/thrown_balls.hpp"

namespace kolsky {
namespace {

v1::Comparison seen(const testing::ImpactWishes& wishes) {
  ActiveModel active;
  active.file.model = testing::paper_with({});
  v1::Comparison message;
  compare_with_model(testing::impact_shots(wishes).front(), active, message);
  EXPECT_TRUE(message.comparable()) << message.reason();
  return message;
}

testing::ImpactWishes one_shot(std::size_t across) {
  testing::ImpactWishes wishes;
  wishes.seed = 31;
  wishes.speeds_m_per_s = {51.0};
  wishes.shots = 1;
  wishes.across = across;
  return wishes;
}

/// Another code's ball without anything hidden: what its mesh does is no fault of the model's.
TEST(ImpactLight, IsNotRedForWhatTheCalculationMayBeOffBy) {
  EXPECT_NE(seen(one_shot(9)).light(), v1::Comparison::RED);
}

/// A core that stiffens is a small share of the energy, and yet far beyond what a calculation is
/// off by: what `kolsky compare` calls more than that is red.
TEST(ImpactLight, IsRedWhereTheModelFails) {
  testing::ImpactWishes wishes = one_shot(9);
  wishes.core_b = 0.9;
  const v1::Comparison message = seen(wishes);
  EXPECT_EQ(message.light(), v1::Comparison::RED) << message.misfit().chi2_reduced();
  EXPECT_LT(message.excess_share(), 1e-2);
  EXPECT_NE(message.rule().find("calculation"), std::string::npos);
}

}  // namespace
}  // namespace kolsky

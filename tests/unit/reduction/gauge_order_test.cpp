// Gauges that a bench exchanges, on benches solved in the time domain.
#include "processing/reduction/gauge_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "processing/reduction/gauge_silent.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/validity.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::check_of;

/// Two gauges on either bar: g1 and g2 on the input bar, g3 and g4 on the output bar.
Shot four_gauges(const RodMaterial& bars, const RodMaterial& specimen) {
  BenchModel model;
  model.input = {1.2, testing::circle_m2(0.015), bars};
  model.specimen = RodShape{0.004, testing::circle_m2(0.012), specimen};
  model.output = model.input;
  model.pulse = {.peak_force_N = bars.E1_Pa * testing::circle_m2(0.015) * 1e-3,
                 .duration_s = 170e-6,
                 .ramp_s = 40e-6};
  model.gauges = {
      {RodId::input, 0.4}, {RodId::input, 0.7}, {RodId::output, 0.2}, {RodId::output, 0.5}};
  return testing::shot_of(model, testing::records_of(model, 1.4e-3), 4e-6).shot;
}

Reduction reduced(const Shot& shot) {
  ReductionOptions options;
  options.separation = Separation::gauges;
  return Reducer(options).reduce(shot);
}

TEST(GaugeOrder, OfAFiledBenchIsTheFiledOne) {
  for (const RodMaterial& bars : {testing::kPmma, testing::kTitanium}) {
    for (const RodMaterial& specimen : {testing::kCore, testing::kCover, testing::kRubber}) {
      EXPECT_FALSE(gauge_order(four_gauges(bars, specimen)));
    }
  }
}

TEST(GaugeOrder, ThatIsExchangedOnOneBarFailsAndIsNamed) {
  Shot shot = four_gauges(testing::kTitanium, testing::kCover);
  ASSERT_EQ(reduced(shot).quality.find("gauge_order"), nullptr);
  std::swap(shot.bench.gauges[0].position_m, shot.bench.gauges[1].position_m);
  const Reduction reduction = reduced(shot);
  const Check& order = check_of(reduction, "gauge_order");
  EXPECT_EQ(order.verdict, Verdict::fail);
  EXPECT_NEAR(order.value, 0.3 / 5050.0, 3e-6);  // titanium's bar wave over 0.3 m
  EXPECT_NE(order.text.find("come to g1"), std::string::npos) << order.text;
  EXPECT_NE(order.text.find("before g2"), std::string::npos) << order.text;
  EXPECT_FALSE(quotable_part(reduction).any);
  EXPECT_NE(quotable_part(reduction).text.find("exchanged"), std::string::npos);
}

TEST(GaugeOrder, OfCablesExchangedBetweenBarsFails) {
  Shot shot = four_gauges(testing::kTitanium, testing::kCover);
  std::swap(shot.channels[1].codes, shot.channels[2].codes);
  const Reduction reduction = reduced(shot);
  EXPECT_EQ(check_of(reduction, "gauge_order").verdict, Verdict::fail);
}

TEST(GaugeOrder, IsAskedForWhereNothingCanBeReduced) {
  Shot shot = four_gauges(testing::kTitanium, testing::kCover);
  std::swap(shot.channels[0].codes, shot.channels[3].codes);
  for (ChannelRecord& channel : shot.channels) {
    channel.codes.resize(800);
  }
  const Quality quality = reduced(shot).quality;
  ASSERT_FALSE(quality.reducible);
  EXPECT_NE(quality.mend.find("exchanged"), std::string::npos) << quality.mend;
}

// Bending makes one of a pair read more, which is passed sooner at one height whatever is listed
// first.
TEST(GaugeOrder, OfAPairIsNone) {
  Shot shot = four_gauges(testing::kTitanium, testing::kCover);
  shot.bench.gauges[1].position_m = shot.bench.gauges[0].position_m;
  shot.channels[1].codes = shot.channels[0].codes;
  for (std::int32_t& code : shot.channels[0].codes) {
    code = static_cast<std::int32_t>(0.7 * code);
  }
  EXPECT_FALSE(gauge_order(shot));
}

// The mean of a pair holds half of what its sound gauge reads, and no number says why.
TEST(GaugeSilent, OfAPairIsNamed) {
  Shot shot = four_gauges(testing::kTitanium, testing::kCover);
  EXPECT_FALSE(gauge_silent(shot));
  shot.bench.gauges[1].position_m = shot.bench.gauges[0].position_m;
  shot.channels[1].codes = shot.channels[0].codes;
  ASSERT_EQ(Reducer(ReductionOptions{}).reduce(shot).quality.find("gauge_silent"), nullptr);
  std::ranges::fill(shot.channels[1].codes, 0);
  const Reduction reduction = Reducer(ReductionOptions{}).reduce(shot);
  const Check& silent = check_of(reduction, "gauge_silent");
  EXPECT_EQ(silent.verdict, Verdict::fail);
  EXPECT_EQ(silent.text.find("g2 reads 0 % of what g1 does"), 0U) << silent.text;
  EXPECT_NE(quotable_part(reduction).text.find("open lead"), std::string::npos);
}

}  // namespace
}  // namespace kolsky

// Channels that read with the other sign, on benches solved in the time domain.
#include "processing/reduction/gauge_sign.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/reduction/validity.hpp"
#include "tests/unit/reduction/solved_bench.hpp"

namespace kolsky {
namespace {

using testing::check_of;

Shot solved(const RodMaterial& bars, const RodMaterial& specimen) {
  BenchModel model;
  model.input = {1.2, testing::circle_m2(0.015), bars};
  model.specimen = RodShape{0.004, testing::circle_m2(0.012), specimen};
  model.output = model.input;
  model.pulse = {.peak_force_N = bars.E1_Pa * testing::circle_m2(0.015) * 1e-3,
                 .duration_s = 170e-6,
                 .ramp_s = 40e-6};
  model.gauges = {{RodId::input, 0.5}, {RodId::output, 0.2}};
  return testing::shot_of(model, testing::records_of(model, 1.4e-3), 4e-6).shot;
}

void turn_round(ChannelRecord& channel) {
  channel.scale = -channel.scale;
}

TEST(GaugeSign, OfChannelsThatReadAsFiledIsNotMentioned) {
  for (const RodMaterial& bars : {testing::kPmma, testing::kTitanium}) {
    for (const RodMaterial& specimen : {testing::kCore, testing::kCover, testing::kRubber}) {
      const Shot shot = solved(bars, specimen);
      EXPECT_FALSE(gauge_sign(shot));
      EXPECT_EQ(Reducer().reduce(shot).quality.find("gauge_sign"), nullptr);
    }
  }
}

TEST(GaugeSign, OfOneThatIsInvertedFailsNamesItAndIsFiledSo) {
  for (const std::size_t which : {0U, 1U}) {
    Shot shot = solved(testing::kTitanium, testing::kCover);
    const Reduction right = Reducer().reduce(shot);
    turn_round(shot.channels[which]);
    const Reduction wrong = Reducer().reduce(shot);
    const Check& sign = check_of(wrong, "gauge_sign");
    EXPECT_EQ(sign.verdict, Verdict::fail);
    EXPECT_EQ(wrong.quality.checks.front().name, "gauge_sign");
    EXPECT_NE(sign.text.find("tension at " + shot.bench.gauges[which].name + " and"),
              std::string::npos)
        << sign.text;
    EXPECT_NE(quotable_part(wrong).text.find("inverted = true"), std::string::npos);
    shot.bench.gauges[which].inverted = true;
    const Reduction mended = Reducer().reduce(shot);
    EXPECT_EQ(mended.stress_Pa, right.stress_Pa);
    EXPECT_EQ(mended.quality.find("gauge_sign"), nullptr);
  }
}

// The back's force pulls at the specimen then: not to be told as the cause.
TEST(GaugeSign, OfAnOutputThatIsInvertedIsWhyThereIsNoLoading) {
  Shot shot = solved(testing::kPmma, testing::kCore);
  turn_round(shot.channels.back());
  ReductionOptions options;
  options.stress = StressFrom::back;
  const LoopSummary loop = summarise(Reducer(options).reduce(shot));
  EXPECT_NE(loop.no_loading.find("gauge_sign"), std::string::npos) << loop.no_loading;
  EXPECT_EQ(loop.no_loading.find("lengthened"), std::string::npos) << loop.no_loading;
}

TEST(GaugeSign, OfAllThatAreInvertedWarnsUnlessTheBarsAreLoadedSo) {
  Shot shot = solved(testing::kTitanium, testing::kCover);
  std::ranges::for_each(shot.channels, turn_round);
  const Reduction r = Reducer().reduce(shot);
  EXPECT_EQ(check_of(r, "gauge_sign").verdict, Verdict::warn);
  EXPECT_NE(check_of(r, "gauge_sign").text.find("loading = \"tension\""), std::string::npos);
  shot.bench.loading = PositiveSense::tension;
  EXPECT_EQ(Reducer().reduce(shot).quality.find("gauge_sign"), nullptr);
}

TEST(GaugeSign, OfOneOfAPairAcrossTheBarIsAskedForWhereNothingCanBeReduced) {
  Shot shot = solved(testing::kTitanium, testing::kCover);
  shot.bench.gauges.push_back(shot.bench.gauges.front());
  shot.bench.gauges.back().name = "g1b";
  shot.channels.push_back(shot.channels.front());
  shot.channels.back().gauge = "g1b";
  turn_round(shot.channels.back());  // the pair's mean holds no pulse
  const Quality quality = Reducer().reduce(shot).quality;
  ASSERT_FALSE(quality.reducible);
  EXPECT_NE(quality.mend.find("g1b seems to read with the other sign"), std::string::npos)
      << quality.mend;
}

}  // namespace
}  // namespace kolsky

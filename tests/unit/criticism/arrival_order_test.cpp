#include "processing/criticism/records/arrival_order.hpp"

#include <gtest/gtest.h>

#include <utility>

#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

testing::Campaign drawn(std::uint64_t seed, bool split) {
  return testing::draw_campaign({.seed = seed, .shots = 2, .gauges = 4, .split = split});
}

std::optional<std::string> said_of(const testing::Campaign& truth) {
  return out_of_order(read_campaign(testing::shots_of(truth)));
}

TEST(ArrivalOrder, OfAFiledBenchIsTheFiledOne) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    EXPECT_EQ(said_of(drawn(seed, false)), std::nullopt) << seed;
    EXPECT_EQ(said_of(drawn(seed, true)), std::nullopt) << seed;
  }
}

TEST(ArrivalOrder, NamesGaugesThatWereExchanged) {
  testing::Campaign truth = drawn(7, false);
  auto& gauges = truth.bench.gauges;
  std::swap(gauges[1].position_m, gauges[2].position_m);
  const std::optional<std::string> said = said_of(truth);
  ASSERT_TRUE(said);
  EXPECT_NE(said->find("pulses come to g2"), std::string::npos) << *said;
  EXPECT_NE(said->find("before g3"), std::string::npos) << *said;
}

TEST(ArrivalOrder, NamesGaugesOfTwoBarsThatWereExchanged) {
  testing::Campaign truth =
      testing::draw_campaign({.seed = 7, .shots = 2, .gauges = 2, .split = true});
  auto& gauges = truth.bench.gauges;
  std::swap(gauges[0].position_m, gauges[1].position_m);
  std::swap(gauges[0].bar, gauges[1].bar);
  const std::optional<std::string> said = said_of(truth);
  ASSERT_TRUE(said);
  EXPECT_NE(said->find("exchanged"), std::string::npos);
}

// A free end that is near sends the pulse back and cuts off the top of what is read there: half of
// that height is passed early.
TEST(ArrivalOrder, IsNotMistakenWhereAnEndLowersOneGaugesPulse) {
  testing::Campaign truth = drawn(3, false);
  auto& world = truth.world;
  for (const auto& [gauge, from_end_m] : {std::pair{2, 0.10}, {3, 0.02}}) {
    const auto g = static_cast<std::size_t>(gauge);
    world.gauges[g].position_m = world.length_m - from_end_m;
    truth.bench.gauges[g].position_m.value = world.gauges[g].position_m;
  }
  testing::hide(truth, testing::parse_effect("end-reflection=0"));
  EXPECT_EQ(said_of(truth), std::nullopt);
}

// A gauge filed 5 mm off the right place is off by what a delay would make up, and in its turn.
TEST(ArrivalOrder, AllowsForAPlaceThatIsOff) {
  testing::Campaign truth = drawn(7, false);
  truth.bench.gauges[2].position_m.value += 5e-3;
  EXPECT_EQ(said_of(truth), std::nullopt);
}

TEST(GaugeSigns, NameAGaugeThatReadsWithTheOther) {
  const testing::Campaign truth = drawn(7, false);
  std::vector<Shot> shots = testing::shots_of(truth);
  EXPECT_EQ(of_other_sign(read_campaign(shots)), std::nullopt);
  for (Shot& shot : shots) {
    for (std::int32_t& code : shot.channels[2].codes) {
      code = -code;
    }
  }
  const std::optional<std::string> said = of_other_sign(read_campaign(shots));
  ASSERT_TRUE(said);
  EXPECT_NE(said->find("a tension at g3 and a compression at the other gauges"), std::string::npos)
      << *said;
}

}  // namespace
}  // namespace kolsky

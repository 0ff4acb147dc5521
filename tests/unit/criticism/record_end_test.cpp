#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr double kReturned = 0.2;

/// Shots on a bar whose far end returns nearly all, recorded until so long after the front of what
/// returns has reached the gauge nearest to that end. No other gauge sees it.
std::vector<Shot> shots_that_end_after(std::uint64_t seed, double front_seen_s) {
  testing::CampaignWishes wishes{
      .seed = seed, .shots = 6, .gauges = 3, .samples = 3000, .rate_Hz = 1e6};
  testing::Campaign truth = testing::draw_campaign(wishes);
  testing::hide(truth, testing::parse_effect("end-reflection=" + std::to_string(kReturned)));
  const testing::BarWorld& world = truth.world;
  const double front_m_per_s = std::sqrt(world.material.E1_Pa / world.material.density_kg_m3);
  const double way_m =
      2.0 * world.length_m - world.gauges.front().position_m - world.gauges.back().position_m;
  const double after_trigger_s = way_m / front_m_per_s + front_seen_s;
  const std::size_t samples =
      world.timing.pretrigger +
      static_cast<std::size_t>(std::lround(after_trigger_s * world.timing.rate_Hz));
  std::vector<Shot> shots = testing::shots_of(truth);
  for (Shot& shot : shots) {
    for (ChannelRecord& channel : shot.channels) {
      channel.codes.resize(samples);
    }
  }
  return shots;
}

class EndOfRecord : public ::testing::TestWithParam<std::uint64_t> {};

// What is not judged before a record's end may hold all that there is of an effect. On these bars
// the pulse rises fast enough to stand out of the noise within what is judged of those 60 us; a
// margin of 8 widths of the filter and a window of small factors leave too little of it.
TEST_P(EndOfRecord, HoldsAReflectionThatHasOnlyJustReachedTheLastGauge) {
  const std::vector<Shot> shots = shots_that_end_after(GetParam(), 60e-6);
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, paper_model(BenchKind::bar, false), {});
  ASSERT_EQ(diagnosis.effects, std::vector<std::string>{"end-reflection"});
  const auto result =
      std::ranges::find(diagnosis.candidates, "end-reflection", &CandidateResult::effect);
  EXPECT_LT(std::abs(result->strength - kReturned), 4.0 * result->sd);
}

INSTANTIATE_TEST_SUITE_P(Seeds, EndOfRecord, ::testing::Values(401, 408, 409));

}  // namespace
}  // namespace kolsky

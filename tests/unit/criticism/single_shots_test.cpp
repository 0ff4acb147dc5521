#include "processing/criticism/verdict/single_shots.hpp"

#include <gtest/gtest.h>

#include <string>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kLoose = 2;     ///< of four gauges
constexpr std::size_t kFirstOff = 1;  ///< of six shots
constexpr std::size_t kSecondOff = 4;

struct Seen {
  testing::NoiseColour colour;
  double further_gain;  ///< of which several deviations remain
};

class OwnReadings : public ::testing::TestWithParam<Seen> {};

testing::CampaignWishes six_shots(testing::NoiseColour colour, std::uint64_t seed) {
  return {.seed = seed, .shots = 6, .gauges = 4, .colour = colour, .samples = 1500, .rate_Hz = 1e6};
}

/// Records in which one gauge reads more in two of the shots.
Diagnosis diagnosed(const testing::Campaign& campaign, double further_gain) {
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  for (const std::size_t shot : {kFirstOff, kSecondOff}) {
    for (double& strain : readings[shot][kLoose]) {
      strain *= 1.0 + further_gain;
    }
  }
  const std::vector<Shot> shots = testing::shots_of(campaign, readings);
  const Campaign read = read_campaign(shots);
  Study study(read, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

// Two of six do not agree with the mean, so that what differs passes for noise where noise is
// whatever differs.
TEST_P(OwnReadings, OfAGaugeThatComesLooseNowAndThenAreNoNoise) {
  for (std::uint64_t seed = 811; seed < 815; ++seed) {
    const testing::Campaign campaign = testing::draw_campaign(six_shots(GetParam().colour, seed));
    const Diagnosis off = diagnosed(campaign, GetParam().further_gain);
    EXPECT_EQ(name_of(off.verdict), "unknown") << seed;
    ASSERT_FALSE(off.notes.empty()) << seed;
    const std::string& gauge = campaign.bench.gauges[kLoose].name;
    EXPECT_NE(off.notes.front().find("furthest is " + gauge), std::string::npos)
        << seed << ": " << off.notes.front();
    const Diagnosis alike = diagnosed(campaign, 0.0);
    EXPECT_EQ(name_of(alike.verdict), "adequate") << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(White, OwnReadings,
                         ::testing::Values(Seen{testing::NoiseColour::white, 0.015}));
INSTANTIATE_TEST_SUITE_P(Pink, OwnReadings,
                         ::testing::Values(Seen{testing::NoiseColour::pink, 0.03}));

}  // namespace
}  // namespace kolsky

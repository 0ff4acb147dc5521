// What a gauge adds to the pulses that goes with the amplitude comes back in no shot, and is no
// noise all the same.
#include "processing/criticism/verdict/loud_pulses.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

constexpr std::size_t kBent = 3;  ///< of four gauges

testing::Campaign eight_shots(std::uint64_t seed, testing::NoiseColour colour, int bits = 16) {
  return testing::draw_campaign({.seed = seed,
                                 .shots = 8,
                                 .gauges = 4,
                                 .noise_strain = 3e-6,
                                 .colour = colour,
                                 .bits = bits,
                                 .samples = 1500,
                                 .rate_Hz = 1e6});
}

/// Records of a gauge whose converter's steps are not alike: off by a sine of what it reads.
Diagnosis diagnosed(const testing::Campaign& campaign, double off_strain) {
  constexpr double kPeriod_strain = 170e-6;
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  for (auto& of_shot : readings) {
    for (double& strain : of_shot[kBent]) {
      strain += off_strain * std::sin(2.0 * std::numbers::pi * strain / kPeriod_strain);
    }
  }
  const Campaign read = read_campaign(testing::shots_of(campaign, readings));
  Study study(read, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

TEST(LoudPulses, OfAConverterWhoseStepsAreNotAlikeAreNoNoise) {
  for (std::uint64_t seed = 821; seed < 824; ++seed) {
    const testing::Campaign campaign = eight_shots(seed, testing::NoiseColour::white);
    const Diagnosis diagnosis = diagnosed(campaign, 4e-6);
    EXPECT_EQ(name_of(diagnosis.verdict), "unknown") << seed;
    ASSERT_FALSE(diagnosis.notes.empty()) << seed;
    EXPECT_NE(diagnosis.notes.front().find(campaign.bench.gauges[kBent].name + " reads the pulses"),
              std::string::npos)
        << seed << ": " << diagnosis.notes.front();
  }
}

TEST(LoudPulses, AreNotWhatNoiseOfAnyColourAndCoarseStepsMake) {
  for (const auto colour :
       {testing::NoiseColour::white, testing::NoiseColour::coloured, testing::NoiseColour::pink}) {
    for (const int bits : {8, 16}) {
      const testing::Campaign campaign = eight_shots(831, colour, bits);
      EXPECT_EQ(name_of(diagnosed(campaign, 0.0).verdict), "adequate") << bits;
    }
  }
}

}  // namespace
}  // namespace kolsky

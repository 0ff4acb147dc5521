// What a gauge adds to the pulses that goes with the amplitude comes back in no shot, and is no
// noise all the same.
#include "processing/criticism/verdict/loud_pulses.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

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
Diagnosis diagnosed(const testing::Campaign& campaign, std::size_t gauge, double off_strain) {
  constexpr double kPeriod_strain = 170e-6;
  testing::CampaignForward forward;
  testing::Readings readings = forward.readings(campaign);
  for (auto& of_shot : readings) {
    for (double& strain : of_shot[gauge]) {
      strain += off_strain * std::sin(2.0 * std::numbers::pi * strain / kPeriod_strain);
    }
  }
  const Campaign read = read_campaign(testing::shots_of(campaign, readings));
  Study study(read, 0.0, Workers{});
  return diagnose(study, paper_model(BenchKind::bar, false), {});
}

bool says(const Diagnosis& diagnosis, const std::string& words) {
  return std::ranges::any_of(diagnosis.notes, [&](const std::string& note) {
    return note.find(words) != std::string::npos;
  });
}

// The first gauge is what all others are reckoned from: an error of it is in all their residuals.
TEST(LoudPulses, OfAConverterWhoseStepsAreNotAlikeAreNoNoise) {
  for (const std::size_t bent : {0U, 2U, 3U}) {
    for (std::uint64_t seed = 821; seed < 823; ++seed) {
      const testing::Campaign campaign = eight_shots(seed, testing::NoiseColour::white);
      const Diagnosis diagnosis = diagnosed(campaign, bent, 4e-6);
      EXPECT_EQ(name_of(diagnosis.verdict), "unknown") << seed;
      const std::string name = campaign.bench.gauges[bent].name;
      EXPECT_TRUE(says(diagnosis, name + " reads the pulses") ||
                  says(diagnosis, "most of it is at " + name))
          << seed << ", " << name;
    }
  }
}

// Of two gauges either may be the one.
TEST(LoudPulses, OfTwoGaugesAreEithers) {
  testing::CampaignWishes wishes = eight_shots(821, testing::NoiseColour::white).wishes;
  wishes.gauges = 2;
  for (const std::size_t bent : {0U, 1U}) {
    const Diagnosis diagnosis = diagnosed(testing::draw_campaign(wishes), bent, 5e-6);
    EXPECT_TRUE(says(diagnosis, "g1 or g2 reads the pulses") ||
                says(diagnosis, "g2 or g1 reads the pulses"))
        << bent;
  }
}

TEST(LoudPulses, AreNotWhatNoiseOfAnyColourAndCoarseStepsMake) {
  for (const auto colour :
       {testing::NoiseColour::white, testing::NoiseColour::coloured, testing::NoiseColour::pink}) {
    for (const int bits : {8, 16}) {
      const testing::Campaign campaign = eight_shots(831, colour, bits);
      EXPECT_EQ(name_of(diagnosed(campaign, 0, 0.0).verdict), "adequate") << bits;
    }
  }
}

testing::Campaign on_coarse_steps(std::uint64_t seed, double noise_strain,
                                  const std::vector<std::string>& effects) {
  testing::Campaign campaign = testing::draw_campaign(
      {.seed = seed, .shots = 6, .gauges = 4, .noise_strain = noise_strain, .bits = 8});
  for (const std::string& effect : effects) {
    testing::hide(campaign, testing::parse_effect(effect));
  }
  return campaign;
}

// Like shots have like saw teeth, which repeat; and a bending of -11 um gained as much by them as
// by noise once in 400 campaigns.
TEST(CoarseSteps, FarAboveTheNoiseAreNothingThatIsMissing) {
  EXPECT_EQ(name_of(diagnosed(on_coarse_steps(90001, 2e-6, {}), 0, 0.0).verdict), "adequate");
  EXPECT_EQ(name_of(diagnosed(on_coarse_steps(93003, 2e-6, {}), 0, 0.0).verdict), "adequate");
  EXPECT_EQ(name_of(diagnosed(on_coarse_steps(94008, 4e-6, {}), 0, 0.0).verdict), "adequate");
}

TEST(CoarseSteps, HideNothingThatIsFarAboveThem) {
  const Diagnosis diagnosis =
      diagnosed(on_coarse_steps(90001, 2e-6, {"gauge-factor:g2=0.03"}), 0, 0.0);
  EXPECT_EQ(name_of(diagnosis.verdict), "named");
  EXPECT_EQ(diagnosis.effects, std::vector<std::string>{"gauge-factor:g2"});
}

}  // namespace
}  // namespace kolsky

// Specimens as solids of revolution, which no effect of the library is: what is said of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

Diagnosis said_of(std::uint64_t seed, double friction, int shots = 6, double noise_strain = 0.0) {
  testing::CampaignWishes draw{.seed = seed, .shots = shots, .split = true, .solid_specimen = true};
  if (noise_strain > 0.0) {
    draw.noise_strain = noise_strain;
  }
  testing::Campaign truth = testing::draw_campaign(draw);
  truth.split->specimen.friction = friction;
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  return diagnose(
      study, truth.filed_bars ? filed_split_bar(truth) : paper_model(BenchKind::shpb, true), {});
}

// Waves cross it along and across: the definition has the first alone, with strength 1.
TEST(SolidSpecimen, WithoutFrictionLacksInertia) {
  for (const std::uint64_t seed : {1U, 3U}) {
    const Diagnosis diagnosis = said_of(seed, 0.0);
    ASSERT_EQ(diagnosis.effects.size(), 1U) << seed;
    EXPECT_EQ(diagnosis.effects.front(), "specimen-inertia") << seed;
    for (const CandidateResult& candidate : diagnosis.candidates) {
      if (candidate.effect == "specimen-inertia") {
        EXPECT_NEAR(candidate.strength, 1.0, 2.5 * candidate.sd) << seed;
      }
    }
  }
}

// Coulomb's friction turns with the direction in which faces slide and goes beside inertia both
// ways: three things, one of which no definition has. Nothing else may be named for them.
TEST(SolidSpecimen, ThatRubsIsUnknownRatherThanAnotherEffect) {
  for (const std::uint64_t seed : {1U, 4U}) {
    const Diagnosis diagnosis = said_of(seed, 0.2);
    EXPECT_NE(diagnosis.verdict, DiagnosisVerdict::adequate) << seed;
    for (const std::string& id : diagnosis.effects) {
      EXPECT_TRUE(id == "specimen-inertia" || id == "radial-inertia" || id == "interface-friction")
          << seed << ": " << id;
    }
  }
}

// No other shot shows that what is left would come back: half as much again as noise is too much.
TEST(SolidSpecimen, ThatRubsIsUnknownByOneShotToo) {
  const Diagnosis diagnosis = said_of(3, 0.3, 1, 1e-6);
  EXPECT_EQ(diagnosis.verdict, DiagnosisVerdict::unknown);
  EXPECT_TRUE(std::ranges::any_of(diagnosis.notes, [](const std::string& note) {
    return note.find("of one shot nothing tells noise from what is missing") != std::string::npos;
  }));
}

}  // namespace
}  // namespace kolsky

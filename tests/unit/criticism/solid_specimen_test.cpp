// Specimens as solids of revolution, which no effect of the library is: what is said of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>

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

// A soft one of 11 mm by 3 mm has a resonance of its section within the pulse's band. That it has
// mass and widens is no surprise, and hides no gauge that is off.
TEST(SolidSpecimen, ThatIsSoftIsToldFromItsGauge) {
  testing::CampaignWishes draw{.seed = 2, .shots = 5, .split = true, .solid_specimen = true};
  draw.noise_strain = 1.5e-6;
  testing::Campaign truth = testing::draw_campaign(draw);
  testing::hide(truth, testing::parse_effect("gauge-factor:g1=0.01"));
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(
      study, truth.filed_bars ? filed_split_bar(truth) : paper_model(BenchKind::shpb, true), {});
  EXPECT_EQ(std::set<std::string>(diagnosis.effects.begin(), diagnosis.effects.end()),
            (std::set<std::string>{"specimen-inertia", "radial-inertia", "gauge-factor:g1"}));
  const std::map<std::string, double> hidden{
      {"specimen-inertia", 1.0}, {"radial-inertia", 1.0}, {"gauge-factor:g1", 0.01}};
  for (const CandidateResult& candidate : diagnosis.candidates) {
    if (hidden.contains(candidate.effect)) {
      EXPECT_NEAR(candidate.strength, hidden.at(candidate.effect), 3.0 * candidate.sd)
          << candidate.effect;
    }
  }
  EXPECT_LT(diagnosis.after.chi2_reduced, 1.1);
  // By the first term of radial inertia E1 came out 13 % off.
  ASSERT_TRUE(diagnosis.model);
  const EffectUse* specimen = diagnosis.model->find("three-element-specimen");
  ASSERT_NE(specimen, nullptr);
  EXPECT_NEAR(specimen->values[0].value, truth.split->specimen.E1_Pa,
              0.02 * truth.split->specimen.E1_Pa);
  EXPECT_NEAR(specimen->values[2].value, truth.split->specimen.eta2_Pa_s,
              0.05 * truth.split->specimen.eta2_Pa_s);
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

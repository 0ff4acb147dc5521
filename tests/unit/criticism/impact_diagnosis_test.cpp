#include "processing/criticism/impact_diagnosis.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "processing/base/error.hpp"
#include "tests/generators/impact_campaign.hpp"

namespace kolsky {
namespace {

bool holds(const Diagnosis& diagnosis, const std::string& id) {
  for (const std::string& own : diagnosis.effects) {
    const auto& ties = diagnosis.tied_with.at(own);
    if (own == id || std::find(ties.begin(), ties.end(), id) != ties.end()) {
      return true;
    }
  }
  return false;
}

std::string told(const Diagnosis& diagnosis) {
  std::string text = name_of(diagnosis.verdict);
  for (const std::string& own : diagnosis.effects) {
    text += " " + own;
    for (const std::string& tie : diagnosis.tied_with.at(own)) {
      text += "~" + tie;
    }
  }
  for (const std::string& note : diagnosis.notes) {
    text += "\n  " + note;
  }
  for (const CandidateResult& c : diagnosis.candidates) {
    text += "\n    " + c.effect + " " + std::to_string(c.strength) + " +- " + std::to_string(c.sd) +
            " gain " + std::to_string(c.gain) + " " + c.verdict;
  }
  return text;
}

Diagnosis diagnosed(const std::vector<Shot>& shots) {
  const Campaign campaign = read_campaign(shots);
  ImpactStudy study(campaign, false, 0.0, Workers{});
  return diagnose_impacts(study, paper_model(BenchKind::impact, true), {});
}

testing::ImpactWishes wishes(std::uint64_t seed) {
  testing::ImpactWishes own;
  own.seed = seed;
  return own;
}

TEST(ImpactDiagnosis, ALinearBallIsAdequate) {
  const Diagnosis diagnosis = diagnosed(testing::impact_shots(wishes(11)));
  EXPECT_EQ(diagnosis.verdict, DiagnosisVerdict::adequate) << told(diagnosis);
}

TEST(ImpactDiagnosis, FindsACoreThatStiffens) {
  testing::ImpactWishes own = wishes(12);
  own.core_b = 0.6;
  const Diagnosis diagnosis = diagnosed(testing::impact_shots(own));
  EXPECT_TRUE(holds(diagnosis, "core-nonlinearity")) << told(diagnosis);
  // Measured against another code: the strength is as good as the two codes agree.
  const EffectUse* found = diagnosis.model->find("core-nonlinearity");
  ASSERT_NE(found, nullptr);
  EXPECT_NEAR(found->values[0].value, 0.6, 0.1);
  EXPECT_LT(diagnosis.held_out.after, 1.5 * diagnosis.held_out.floor) << told(diagnosis);
  EXPECT_GT(diagnosis.held_out.before, 3.0 * diagnosis.held_out.after);
}

TEST(ImpactDiagnosis, FindsACoreThatSoftens) {
  testing::ImpactWishes own = wishes(13);
  own.core_b = -0.4;
  const Diagnosis diagnosis = diagnosed(testing::impact_shots(own));
  EXPECT_TRUE(holds(diagnosis, "core-nonlinearity")) << told(diagnosis);
}

TEST(ImpactDiagnosis, FindsASecondRelaxationOfTheCore) {
  testing::ImpactWishes own = wishes(14);
  own.core_D_per_Pa = 2e-9;
  own.core_tau_s = 1.5e-4;
  const Diagnosis diagnosis = diagnosed(testing::impact_shots(own));
  EXPECT_TRUE(holds(diagnosis, "core-second-relaxation")) << told(diagnosis);
}

TEST(ImpactDiagnosis, TellsABridgeFromTheBall) {
  testing::ImpactWishes own = wishes(15);
  own.bridge_b = 240.0;
  const Diagnosis diagnosis = diagnosed(testing::impact_shots(own));
  EXPECT_TRUE(holds(diagnosis, "bridge-nonlinearity")) << told(diagnosis);
}

/// Fitted to the two lower speeds, the stiffening core foretells the third; the linear ball does
/// not.
TEST(ImpactDiagnosis, ForetellsASpeedThatWasHeldOut) {
  testing::ImpactWishes own = wishes(16);
  own.core_b = 0.6;
  std::vector<Shot> all = testing::impact_shots(own);
  const std::vector<Shot> lower(all.begin(), all.begin() + 10);
  Model model = paper_model(BenchKind::impact, true);
  const auto rms_at_51 = [&](const Model& fitted) {
    const Campaign campaign = read_campaign(all);
    ImpactStudy study(campaign, false, 0.0, Workers{});
    return study.compare(study.as_it_is(fitted)).speeds.back().rms_percent;
  };
  const double before = rms_at_51(model);
  model.effects.push_back(use_named("core-nonlinearity"));
  const Campaign campaign = read_campaign(lower);
  ImpactStudy study(campaign, false, 0.0, Workers{});
  const double after = rms_at_51(study.fit(model).model);
  EXPECT_GT(before, 2.0);
  // Two codes of the same ball differ by so much.
  EXPECT_LT(after, 0.5);
}

TEST(ImpactCampaign, WithoutASpeedNothingIsForetold) {
  std::vector<Shot> shots = testing::impact_shots(wishes(17));
  shots.resize(2);
  shots[1].meta.erase("incident_speed_m_per_s");
  try {
    static_cast<void>(read_campaign(shots));
    FAIL() << "a shot without a speed was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("incident_speed_m_per_s"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("--meta"), std::string::npos);
  }
  shots[1].meta["incident_speed_m_per_s"] = "fast";
  EXPECT_THROW(static_cast<void>(read_campaign(shots)), InputError);
  shots[1].meta["incident_speed_m_per_s"] = "-31.1";
  EXPECT_THROW(static_cast<void>(read_campaign(shots)), InputError);
}

}  // namespace
}  // namespace kolsky

// An effect that is one file more than the library has: nothing else knows of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drivers/files/models/model_file.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "processing/models/admission.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

Campaign captured(std::uint64_t seed) {
  const testing::Campaign made = testing::draw_campaign({.seed = seed,
                                                         .shots = 6,
                                                         .tolerances = testing::Tolerances::none,
                                                         .samples = 2048,
                                                         .rate_Hz = 1e6});
  return read_campaign(testing::shots_of(made));
}

/// What a capacitor does to a record, charge by charge, in time.
void couple(std::vector<double>& record, double per_s, double period_s) {
  double charge = 0.0;
  for (double& reading : record) {
    const double through = reading - charge;
    charge += through * -std::expm1(-per_s * period_s);
    reading = through;
  }
}

TEST(NewEffect, IsAdmitted) {
  const Effect& effect = *use_named("ac-coupling:g2").effect;
  for (const BenchKind kind : {BenchKind::bar, BenchKind::shpb}) {
    const auto problem = admission_problem(effect, paper_model(kind, false), admission_bench(kind));
    EXPECT_FALSE(problem) << problem->check << ": " << problem->what;
  }
}

TEST(NewEffect, IsReadFromAModelFileAndWritten) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  file.model.effects.push_back(use_named("ac-coupling:g2"));
  file.model.effects.back().values[0].value = 80.0;
  const Model read = parse_model(format_model(file), "m.toml").model;
  ASSERT_NE(read.find("ac-coupling:g2"), nullptr);
  EXPECT_EQ(read.find("ac-coupling:g2")->values[0].value, 80.0);
}

TEST(NewEffect, IsNamedWhereItIsHiddenAndTheErrorFallsToTheFloor) {
  Campaign campaign = captured(83);
  constexpr double kHidden_per_s = 60.0;
  for (CampaignShot& shot : campaign.shots) {
    couple(shot.strain[1], kHidden_per_s, campaign.period_s);
  }
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, paper_model(BenchKind::bar, false), {});
  ASSERT_EQ(diagnosis.effects, std::vector<std::string>{"ac-coupling:g2"});
  const ModelValue& found = diagnosis.model->find("ac-coupling:g2")->values[0];
  EXPECT_NEAR(found.value, kHidden_per_s, 4.0 * found.sd);
  EXPECT_NEAR(diagnosis.held_out.after, diagnosis.held_out.floor, 0.06);
}

TEST(NewEffect, IsNotNamedWhereItIsNot) {
  const Campaign campaign = captured(84);
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, paper_model(BenchKind::bar, false), {});
  EXPECT_EQ(diagnosis.verdict, DiagnosisVerdict::adequate);
}

}  // namespace
}  // namespace kolsky

// Campaigns with nothing hidden whose slow noise a model foretells too strong: gauges as long as a
// wave see next to nothing of short waves, what the ends of the window leak of slow noise is then
// all that residuals hold, and a few hundred quiet samples tell badly how strong that is.
#include <gtest/gtest.h>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/hidden_effects/case_draw.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

Diagnosis diagnosed(const testing::Campaign& truth) {
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, filed_split_bar(truth), {});
}

// With lengths of 102 mm half of the noise foretold was found.
TEST(GaugeLength, IsNotNamedForNoiseThatIsForetoldTooStrong) {
  constexpr int kBench = 392;
  scoring::Plan plan;
  plan.seed = 52002;
  plan.split = true;
  plan.truth_anew = false;
  plan.singles_per_bench = plan.tied_per_bench = plan.doubles_per_bench = 0;
  plan.absorbed_per_bench = plan.withheld_per_bench = 0;
  const testing::Campaign truth = scoring::draw_cases(plan, kBench).at(0).campaign;
  EXPECT_EQ(diagnosed(truth).effects, std::vector<std::string>{});
}

// Lengths of 130 and 140 mm at both gauges, and 76 mm beside a radial inertia, took half of the
// noise away, and left shots apart or something unknown.
TEST(GaugeLength, LeavesSlowNoiseThatLeaksAdequate) {
  for (const std::uint64_t seed : {13U, 20U, 74U}) {
    const testing::CampaignWishes wishes{.seed = seed,
                                         .shots = 6,
                                         .gauges = 2,
                                         .noise_strain = 4.5e-6,
                                         .colour = testing::NoiseColour::coloured,
                                         .tolerances = testing::Tolerances::filed,
                                         .split = true};
    EXPECT_EQ(diagnosed(testing::draw_campaign(wishes)).verdict, DiagnosisVerdict::adequate)
        << seed;
  }
}

// Of a rubber whose moduli are a tenth of those that the fit begins with it ended beside its least,
// and what let it out was claimed: a delay of 0.02 us that is known to 0.19.
TEST(SoftSpecimens, AreNotLeftWhereAFitHasGoneAstray) {
  scoring::Plan plan;
  plan.seed = 143143;
  plan.split = plan.soft = true;
  plan.truth_anew = false;
  plan.singles_per_bench = plan.tied_per_bench = plan.doubles_per_bench = 0;
  plan.absorbed_per_bench = plan.withheld_per_bench = 0;
  for (const int bench : {8, 42}) {
    const testing::Campaign truth = scoring::draw_cases(plan, bench).at(0).campaign;
    EXPECT_EQ(diagnosed(truth).verdict, DiagnosisVerdict::adequate) << bench;
  }
}

}  // namespace
}  // namespace kolsky

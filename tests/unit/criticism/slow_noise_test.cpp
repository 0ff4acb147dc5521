// Campaigns with nothing hidden whose slow noise a model may foretell too strong.
#include <gtest/gtest.h>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/hidden_effects/case_draw.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

// Two gauges as long as a wave see next to nothing of short waves; what the ends of the window leak
// of slow noise is then all that residuals hold, and a few hundred quiet samples tell badly how
// strong that is. With lengths of 102 mm half of the noise foretold was found.
TEST(GaugeLength, IsNotNamedForNoiseThatIsForetoldTooStrong) {
  constexpr int kBench = 392;
  scoring::Plan plan;
  plan.seed = 52002;
  plan.split = true;
  plan.singles_per_bench = plan.tied_per_bench = plan.doubles_per_bench = 0;
  plan.absorbed_per_bench = plan.withheld_per_bench = 0;
  const testing::Campaign truth = scoring::draw_cases(plan, kBench).at(0).campaign;
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  EXPECT_EQ(diagnose(study, filed_split_bar(truth), {}).effects, std::vector<std::string>{});
}

}  // namespace
}  // namespace kolsky

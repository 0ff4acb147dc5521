// A fit that first order leads astray is begun elsewhere before its effect is given up.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky {
namespace {

/// What is claimed, and what cannot be told from it.
std::vector<std::string> said_of(const testing::CampaignWishes& wishes, const std::string& hidden) {
  testing::Campaign truth = testing::draw_campaign(wishes);
  testing::hide(truth, testing::parse_effect(hidden));
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  Model model = paper_model(wishes.split ? BenchKind::shpb : BenchKind::bar, wishes.elastic);
  const Diagnosis diagnosis = diagnose(study, model, {});
  std::vector<std::string> said;
  for (const std::string& id : diagnosis.effects) {
    said.push_back(id);
    const auto& ties = diagnosis.tied_with.at(id);
    said.insert(said.end(), ties.begin(), ties.end());
  }
  return said;
}

// An echo of the far end may have either sign; first order of one speaks against the other.
TEST(EndReflection, IsFoundWeakAndOfEitherSign) {
  for (const std::uint64_t seed : {21U, 22U, 23U}) {
    for (const char* r : {"0.96", "1.04"}) {
      testing::CampaignWishes wishes{
          .seed = seed, .shots = 4, .gauges = 3, .samples = 3000, .rate_Hz = 1e6};
      EXPECT_EQ(said_of(wishes, std::string("end-reflection=") + r),
                std::vector<std::string>{"end-reflection"})
          << "seed " << seed << ", r = " << r;
    }
  }
}

TEST(SpecimenRelaxation, QuickerThanWhatFirstOrderBeginsWithIsInTheSet) {
  testing::CampaignWishes wishes{
      .seed = 5, .shots = 4, .gauges = 3, .split = true, .elastic = true};
  const std::vector<std::string> said =
      said_of(wishes, "specimen-second-relaxation=1.9e-9,tau=4e-6");
  EXPECT_NE(std::ranges::find(said, "specimen-second-relaxation"), said.end())
      << ::testing::PrintToString(said);
}

}  // namespace
}  // namespace kolsky

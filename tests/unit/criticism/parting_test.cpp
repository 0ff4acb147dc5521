// Specimens that lie loose between the bars, made by a march in time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

/// Long enough for waves to come back and pull.
testing::Campaign loose(std::uint64_t seed, const char* gap) {
  testing::Campaign truth = testing::draw_campaign({.seed = seed,
                                                    .shots = 3,
                                                    .gauges = 2,
                                                    .noise_strain = 6e-6,
                                                    .samples = 1600,
                                                    .rate_Hz = 1e6,
                                                    .split = true,
                                                    .elastic = true});
  testing::hide(truth, testing::parse_effect(gap));
  return truth;
}

Diagnosis diagnosed(const testing::Campaign& truth, const Model& model) {
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  return diagnose(study, model, {});
}

bool tells_of_parting(const Diagnosis& diagnosis) {
  return std::ranges::any_of(diagnosis.notes, [](const std::string& note) {
    return note.find("parting-faces") != std::string::npos;
  });
}

// It was unknown after a search of a minute, or a gap of nothing beside a relaxation.
TEST(PartingFaces, AreToldWhereAllIsExplainedByThem) {
  for (const std::uint64_t seed : {41U, 43U}) {
    const testing::Campaign truth = loose(seed, "interface-gap=1e-12,dry=1");
    const Model model = paper_model(BenchKind::shpb, true);
    const Diagnosis diagnosis = diagnosed(truth, model);
    EXPECT_EQ(diagnosis.verdict, DiagnosisVerdict::unknown) << seed;
    EXPECT_TRUE(tells_of_parting(diagnosis)) << seed;
    Model parting = model;
    parting.effects.push_back(use_named("parting-faces"));
    EXPECT_EQ(diagnosed(truth, parting).verdict, DiagnosisVerdict::adequate) << seed;
  }
}

// Dry faces that have to meet first are a gap's.
TEST(PartingFaces, AreNotToldOfAGap) {
  const Diagnosis diagnosis =
      diagnosed(loose(41, "interface-gap=15e-6,dry=1"), paper_model(BenchKind::shpb, true));
  EXPECT_EQ(diagnosis.effects, std::vector<std::string>{"interface-gap"});
  EXPECT_FALSE(tells_of_parting(diagnosis));
}

}  // namespace
}  // namespace kolsky

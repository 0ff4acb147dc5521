// What stands beside an effect of the specimen's law may be that law itself.
#include "processing/criticism/verdict/other_law.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "tests/generators/campaign.hpp"
#include "tests/unit/criticism/filed_bars.hpp"

namespace kolsky {
namespace {

const std::string kLaw = "specimen-nonlinearity";
const std::string kSensor = "crosstalk:g1";

struct Asked {
  bool missed = false;  ///< the sensor's effect, if it is taken out
  std::optional<std::string> said;
};

/// With both fitted to records that have something else or not.
Asked asked_of(std::initializer_list<const char*> hidden) {
  testing::Campaign truth = testing::draw_campaign(
      {.seed = 16, .shots = 4, .gauges = 3, .noise_strain = 3e-6, .split = true});
  for (const char* effect : hidden) {
    testing::hide(truth, testing::parse_effect(effect));
  }
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Model model = filed_split_bar(truth);
  model.effects.push_back(use_named(kLaw));
  model.effects.push_back(use_named(kSensor));
  Study study(campaign, 0.0, Workers{});
  const Studied fitted = study.fit(model);
  Asked asked{missed_in(study, without(study, fitted, kSensor), fitted), {}};
  if (const auto other = other_law_in_place_of(study, fitted, {kLaw, kSensor})) {
    asked.said = other_law_text(*other);
  }
  return asked;
}

TEST(OtherLaw, OfASpecimenThatSoftensStandsForWhatASensorWouldExplain) {
  const Asked asked = asked_of({"x-softening=1e-6"});
  EXPECT_TRUE(asked.missed);
  ASSERT_TRUE(asked.said.has_value());
  EXPECT_NE(asked.said->find("as well as " + kSensor), std::string::npos) << *asked.said;
}

TEST(OtherLaw, DoesNotStandForASensorThatIsAtFault) {
  const Asked asked = asked_of({"specimen-nonlinearity=1", "crosstalk:g1=0.01"});
  EXPECT_TRUE(asked.missed);
  EXPECT_EQ(asked.said, std::nullopt);
}

// A second claim would be of what the law's formula leaves, and cast doubt on the first.
TEST(OtherLaw, ThatLeavesNextToNothingIsNoSecondClaim) {
  testing::Campaign truth = testing::draw_campaign(
      {.seed = 16, .shots = 4, .gauges = 3, .noise_strain = 3e-6, .split = true});
  testing::hide(truth, testing::parse_effect(kLaw + "=1"));
  testing::hide(truth, testing::parse_effect("x-softening=1.3e-8"));
  const Campaign campaign = read_campaign(testing::shots_of(truth));
  Study study(campaign, 0.0, Workers{});
  const Diagnosis diagnosis = diagnose(study, filed_split_bar(truth), {});
  EXPECT_EQ(diagnosis.effects, std::vector<std::string>{kLaw});
  EXPECT_EQ(diagnosis.verdict, DiagnosisVerdict::named);
  EXPECT_TRUE(std::ranges::any_of(diagnosis.notes, [](const std::string& note) {
    return note.find("may depart from that law") != std::string::npos;
  }));
}

}  // namespace
}  // namespace kolsky

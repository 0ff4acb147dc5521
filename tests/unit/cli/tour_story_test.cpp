#include "clients/cli/reports/tour_story.hpp"

#include <gtest/gtest.h>

namespace kolsky::cli {
namespace {

ModelStep said(const std::string& verdict, const std::vector<std::string>& added,
               const std::vector<std::string>& ties = {}) {
  ModelStep step;
  step.verdict = verdict;
  step.added = added;
  for (const std::string& id : added) {
    step.tests.push_back({id, 2e-3, 1e-4, "m", -50.0, 100.0, verdict, ties});
  }
  for (const std::string& id : ties) {
    step.tests.push_back({id, 5e-6, 1e-6, "s", -48.0, 95.0, "tied", {}});
  }
  return step;
}

const Hidden kPosition{"gauge-position:g3",
                       "delta",
                       "m",
                       2.2e-3,
                       "gauge g3 is not glued where the bench file says",
                       true};
const Hidden kNothing{"", "", "", 0.0, "nothing is hidden", true};
const Hidden kCreep{"creep of the adhesive:g2", "share", "-", 0.05, "gauge g2 creeps", false};

TEST(Tour, IsHonestOfWhatWasFound) {
  EXPECT_EQ(judge(kPosition, said("named", {"gauge-position:g3"})).end, TourEnd::found);
  EXPECT_EQ(judge(kPosition, said("tied", {"gauge-position:g3"}, {"channel-delay:g3"})).end,
            TourEnd::among_tied);
  EXPECT_EQ(judge(kPosition, said("tied", {"channel-delay:g3"}, {"gauge-position:g3"})).end,
            TourEnd::among_tied);
}

TEST(Tour, IsHonestOfWhatWasNotFound) {
  EXPECT_EQ(judge(kPosition, said("adequate", {})).end, TourEnd::missed);
  EXPECT_EQ(judge(kPosition, said("unknown", {})).end, TourEnd::missed);
  EXPECT_EQ(judge(kPosition, said("named", {"crosstalk:g1"})).end, TourEnd::wrong);
  EXPECT_EQ(judge(kPosition, said("named", {"gauge-position:g3", "crosstalk:g1"})).end,
            TourEnd::wrong);
  EXPECT_EQ(judge(kNothing, said("named", {"crosstalk:g1"})).end, TourEnd::wrong);
  EXPECT_EQ(judge(kNothing, said("unknown", {})).end, TourEnd::wrong);
  EXPECT_EQ(judge(kCreep, said("named", {"crosstalk:g1"})).end, TourEnd::wrong);
  EXPECT_EQ(judge(kCreep, said("adequate", {})).end, TourEnd::missed);
}

TEST(Tour, IsHonestWhereThereWasNothingToName) {
  EXPECT_EQ(judge(kNothing, said("adequate", {})).end, TourEnd::rightly_quiet);
  EXPECT_EQ(judge(kCreep, said("unknown", {})).end, TourEnd::rightly_quiet);
}

TEST(Tour, ComparesTheStrengthWithTheTruth) {
  const TourVerdict verdict = judge(kPosition, said("named", {"gauge-position:g3"}));
  EXPECT_EQ(verdict.strength, 2e-3);
  const std::string words = truth_words(kPosition, verdict);
  EXPECT_NE(words.find("2.0 deviations"), std::string::npos) << words;
  EXPECT_FALSE(judge(kPosition, said("adequate", {})).strength.has_value());
}

TEST(Tour, NamesTiesBeforeTheTruthIsTold) {
  const std::string words =
      verdict_words(said("tied", {"gauge-position:g3"}, {"channel-delay:g3"}));
  EXPECT_NE(words.find("channel-delay:g3"), std::string::npos);
  EXPECT_EQ(verdict_words(said("unknown", {})).find("What is missing"), std::string::npos);
}

}  // namespace
}  // namespace kolsky::cli

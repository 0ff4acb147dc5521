// What is said where no place fails.
#include "clients/cli/reports/comparison_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "clients/cli/reports/comparison_page.hpp"
#include "tests/generators/campaign.hpp"

namespace kolsky::cli {
namespace {

Misfit misfit(double chi2_reduced, double degrees_of_freedom) {
  Misfit made;
  made.chi2_reduced = chi2_reduced;
  made.degrees_of_freedom = degrees_of_freedom;
  return made;
}

bool says(const std::string& text, const char* words) {
  return text.find(words) != std::string::npos;
}

TEST(NothingFails, DoesNotSayThatNothingIsMissing) {
  const std::string calm = nothing_fails_words({}, misfit(1.02, 900.0));
  EXPECT_TRUE(says(calm, "no single place stands out")) << calm;
  EXPECT_TRUE(says(calm, "`kolsky diagnose`")) << calm;
  EXPECT_FALSE(says(calm, "all together")) << calm;
}

// A specimen of mass under slow noise: no place of 907 degrees of freedom failed, all did.
TEST(NothingFails, TellsThatAllTogetherHoldMoreThanNoise) {
  EXPECT_FALSE(fails_together(misfit(1.13, 907.0)));
  EXPECT_TRUE(fails_together(misfit(1.1435, 907.0)));
  EXPECT_TRUE(says(nothing_fails_words({}, misfit(1.1435, 907.0)),
                   "all together hold more than the noise before the pulses, by 3.1 deviations"));
}

TEST(NothingFails, KeepsTheWordsOfStrainBesideThat) {
  Model strained = paper_model(BenchKind::bar, false);
  ModelValue& value = strained.effects.front().values.front();
  value.prior_mean = value.value;
  value.prior_sd = 1e-3 * value.value;
  value.value *= 1.01;
  for (const double chi2 : {1.0, 1.2}) {
    const std::string text = nothing_fails_words(strained, misfit(chi2, 907.0));
    EXPECT_TRUE(says(text, "filed numbers are strained")) << text;
    EXPECT_EQ(says(text, "all together"), chi2 > 1.1) << text;
  }
}

/// Nothing is missing, and no place fails.
class Calm : public ::testing::Test {
 protected:
  Calm()
      : campaign_(read_campaign(
            testing::shots_of(testing::draw_campaign({.seed = 7, .shots = 3, .gauges = 3})))),
        study_(campaign_, 0.0, Workers{}) {}

  static bool page_says(const Page& page, const char* words) {
    return std::ranges::any_of(page.sections, [&](const PageSection& section) {
      return std::ranges::any_of(section.text,
                                 [&](const std::string& text) { return says(text, words); });
    });
  }

  Campaign campaign_;
  Study study_;
  Model model_ = paper_model(BenchKind::bar, false);
};

TEST_F(Calm, PageIsGoodOnlyWhereAllTogetherIsNoiseToo) {
  Studied studied = study_.beside_quiet(study_.fit(model_));
  Comparer comparer(study_.residuals(), studied.composition, studied.fit.theta);
  Comparison comparison = comparer.compare(studied.fit.residual, studied.misfit);
  ASSERT_FALSE(fails_anywhere(comparison));
  const auto page = [&] { return comparison_page("", {}, study_, studied, comparer, comparison); };
  EXPECT_TRUE(page().good);
  EXPECT_TRUE(says(page().headline, "No single place stands out of the noise; `kolsky diagnose`"));
  studied.misfit.chi2_reduced = comparison.misfit.chi2_reduced = 1.5;
  EXPECT_FALSE(page().good);
  EXPECT_TRUE(says(page().headline, "all together hold more than the noise"));
  EXPECT_TRUE(page_says(page(), "No single place stands out of the noise; all together hold more"));
}

TEST_F(Calm, PageOfADiagnosisAgreesWithItsVerdict) {
  Diagnosis diagnosis;
  diagnosis.verdict = DiagnosisVerdict::named;
  diagnosis.effects = {"mains-hum"};
  const char* found = "What was found is spread over places or hides in slow noise.";
  EXPECT_TRUE(page_says(diagnosis_page("", study_, model_, diagnosis), found));
  diagnosis.verdict = DiagnosisVerdict::unknown;
  diagnosis.effects.clear();
  const char* unknown = "What is unknown is spread over places or hides in slow noise.";
  EXPECT_TRUE(page_says(diagnosis_page("", study_, model_, diagnosis), unknown));
  diagnosis.verdict = DiagnosisVerdict::adequate;
  EXPECT_FALSE(page_says(diagnosis_page("", study_, model_, diagnosis), "is spread over places"));
}

}  // namespace
}  // namespace kolsky::cli

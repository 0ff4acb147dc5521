#include "clients/cli/reports/diagnosis_text.hpp"

#include <gtest/gtest.h>

#include <limits>

#include <cmath>

namespace kolsky::cli {
namespace {

TEST(GainText, KeepsToItsColumn) {
  EXPECT_EQ(gain_text(53327.54), "53327.5");
  EXPECT_EQ(gain_text(-0.01), "0.0");
  EXPECT_EQ(gain_text(-1.58e25), "-2e+25");
  EXPECT_EQ(gain_text(std::numeric_limits<double>::infinity()), "");
}

TEST(StrengthText, GivesTwoDigitsOfTheDeviationInPowersOfAThousand) {
  EXPECT_EQ(strength_text(3.5161e-6, 9.38e-8, "s"), "(3.516 ± 0.094)e-6 s");
  EXPECT_EQ(strength_text(-0.0041, 0.00095, "1/s"), "(-4.10 ± 0.95)e-3 1/s");
  EXPECT_EQ(strength_text(24.3, 20.4, "-"), "24 ± 20");
  EXPECT_EQ(strength_text(0.98422, 0.00073, "-"), "(984.22 ± 0.73)e-3");
}

TEST(StrengthText, HasNoNegativeNothing) {
  EXPECT_EQ(strength_text(-1e-9, 1e-3, "m"), "(0.0 ± 1.0)e-3 m");
}

TEST(StrengthText, IsEmptyForWhatIsUntestable) {
  EXPECT_EQ(strength_text(NAN, NAN, "m"), "");
}

CandidateResult candidate(const char* effect, CandidateVerdict verdict, double log_p) {
  CandidateResult result;
  result.effect = effect;
  result.verdict = verdict;
  result.unit = "m";
  result.strength = 1e-3;
  result.sd = 1e-4;
  result.log_p = result.own_log_p = log_p;
  return result;
}

TEST(DiagnosisText, PutsWhatIsClaimedFirstAndExplainsTheVerdictsThatAreThere) {
  Diagnosis diagnosis;
  diagnosis.verdict = DiagnosisVerdict::tied;
  diagnosis.model = Model{};
  diagnosis.effects = {"bar-length"};
  diagnosis.tied_with["bar-length"] = {"gauge-position:g1"};
  diagnosis.candidates = {candidate("crosstalk:g2", CandidateVerdict::not_needed, -60.0),
                          candidate("baseline-drift:g1", CandidateVerdict::unconfirmed, -1.0),
                          candidate("bar-length", CandidateVerdict::tied, -40.0),
                          candidate("gauge-length:g1", CandidateVerdict::untestable, 0.0)};
  diagnosis.next_experiment = {{"a further gauge", {"bar-length", "gauge-position:g1"}, 5.0}};
  const std::string text = diagnosis_text(diagnosis);

  const auto at = [&](const char* words) { return text.find(words); };
  EXPECT_NE(at("missing: bar-length   (cannot be told from gauge-position:g1)"), std::string::npos);
  EXPECT_LT(at("\n  bar-length "), at("\n  baseline-drift:g1"));
  EXPECT_LT(at("\n  baseline-drift:g1"), at("\n  crosstalk:g2"));
  EXPECT_NE(at("unconfirmed: "), std::string::npos);
  EXPECT_EQ(at("rejected: "), std::string::npos);
  EXPECT_NE(at("untestable here, for what is fitted takes up all of it or no strength within\n"
               "  reach shows in what is judged: gauge-length:g1"),
            std::string::npos);
  EXPECT_NE(at("next: a further gauge\n        to tell bar-length from gauge-position:g1"),
            std::string::npos);
}

}  // namespace
}  // namespace kolsky::cli

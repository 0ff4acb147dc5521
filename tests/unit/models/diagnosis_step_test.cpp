#include "drivers/files/models/diagnosis_step.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>

namespace kolsky {
namespace {

std::string with_digits_as_0(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char own) { return std::isdigit(own) != 0; }, '0');
  return text;
}

Diagnosis found(DiagnosisVerdict verdict) {
  Diagnosis diagnosis;
  diagnosis.verdict = verdict;
  diagnosis.effects = {"temperature"};
  diagnosis.tied_with["temperature"] = {"bar-modulus"};
  diagnosis.after.chi2_reduced = 1.02;
  diagnosis.after.degrees_of_freedom = 2268.0;
  diagnosis.held_out = {1.78, 0.99, 1.003};
  CandidateResult candidate;
  candidate.effect = "temperature";
  candidate.unit = "1/K";
  candidate.strength = 3e-3;
  candidate.sd = 1e-5;
  candidate.log_p = -700.0;
  candidate.verdict = CandidateVerdict::tied;
  diagnosis.candidates = {candidate};
  Model model = paper_model(BenchKind::bar, false);
  model.effects.push_back(use_named("temperature"));
  diagnosis.model = model;
  return diagnosis;
}

TEST(AddDiagnosis, KeepsAllThatALedgerTellsOfIt) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  // As `compare` has it, whatever a diagnosis reckons by.
  const Misfit left{.chi2_reduced = 1.06};
  add_diagnosis(file, found(DiagnosisVerdict::tied), left, {}, "live, shots of store");
  const ModelFile again = parse_model(format_model(file), "m.toml");
  EXPECT_NE(again.model.find("temperature"), nullptr);
  ASSERT_EQ(again.history.size(), 1U);
  const ModelStep& step = again.history.front();
  EXPECT_EQ(step.action, "diagnose: temperature");
  EXPECT_EQ(with_digits_as_0(step.when), "0000-00-00T00:00:00Z") << step.when;
  EXPECT_EQ(step.note, "live, shots of store");
  EXPECT_EQ(step.verdict, "tied");
  EXPECT_EQ(step.added, std::vector<std::string>{"temperature"});
  EXPECT_EQ(step.fit->chi2_reduced, 1.06);
  EXPECT_EQ(step.held_out->before, 1.78);
  EXPECT_EQ(step.held_out->after, 0.99);
  EXPECT_FALSE(step.seeds.empty());
  ASSERT_EQ(step.tests.size(), 1U);
  EXPECT_EQ(step.tests.front().tied_with, std::vector<std::string>{"bar-modulus"});
}

/// The ledger told of a fit whose numbers the file did not have.
TEST(AddDiagnosis, KeepsTheFitWhereNothingExplainsTheMisfit) {
  ModelFile file;
  file.model = paper_model(BenchKind::bar, false);
  Diagnosis diagnosis = found(DiagnosisVerdict::unknown);
  diagnosis.model = file.model;
  diagnosis.model->effects.front().values.front().value = 5.7e9;
  add_diagnosis(file, diagnosis, {}, {}, "");
  EXPECT_EQ(file.model.effects.front().values.front().value, 5.7e9);
  EXPECT_EQ(file.history.front().verdict, "unknown");
}

}  // namespace
}  // namespace kolsky

#include "drivers/files/models/diagnosis_step.hpp"

#include "processing/criticism/search/search_trials.hpp"

namespace kolsky {

namespace {

StepTest test_of(const CandidateResult& candidate, const Diagnosis& diagnosis) {
  StepTest test{candidate.effect,
                candidate.strength,
                candidate.sd,
                candidate.unit,
                candidate.log_p,
                candidate.held_out_gain,
                name_of(candidate.verdict),
                {}};
  if (const auto ties = diagnosis.tied_with.find(candidate.effect);
      ties != diagnosis.tied_with.end()) {
    test.tied_with = ties->second;
  }
  return test;
}

std::string action_of(const Diagnosis& diagnosis) {
  std::string action = "diagnose:";
  for (const std::string& id : diagnosis.effects) {
    action += " " + id;
  }
  return diagnosis.effects.empty() ? action + " " + name_of(diagnosis.verdict) : action;
}

}  // namespace

StepFit fit_of(const Misfit& misfit, std::size_t captures) {
  return {static_cast<std::int64_t>(captures), misfit.chi2_reduced, misfit.degrees_of_freedom,
          misfit.repeatable_share, misfit.noise_floor_share};
}

void add_diagnosis(ModelFile& file, const Diagnosis& diagnosis, const Misfit& left,
                   const std::vector<std::filesystem::path>& captures, const std::string& note) {
  begin_step(file, action_of(diagnosis));
  ModelStep& step = file.history.back();
  step.note = note;
  step.data_sha256 = digest_of_files(captures);
  step.verdict = name_of(diagnosis.verdict);
  step.added = diagnosis.effects;
  step.fit = fit_of(left, captures.size());
  step.held_out = {diagnosis.held_out.before, diagnosis.held_out.after, diagnosis.held_out.floor};
  step.seeds = {static_cast<double>(kSearchSeed)};
  for (const CandidateResult& candidate : diagnosis.candidates) {
    step.tests.push_back(test_of(candidate, diagnosis));
  }
  // Where nothing explains the misfit it is as it was, fitted.
  if (diagnosis.model) {
    file.model = *diagnosis.model;
  }
}

}  // namespace kolsky

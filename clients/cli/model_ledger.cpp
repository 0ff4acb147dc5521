#include "clients/cli/model_ledger.hpp"

#include <fmt/format.h>

#include <cmath>

#include "processing/criticism/search/search_trials.hpp"

namespace kolsky::cli {

namespace {

JsonValue describe(const StepTest& test) {
  return JsonObject{{"effect", test.effect},
                    {"strength", test.strength},
                    {"sd", test.sd},
                    {"unit", test.unit},
                    {"log_p", test.log_p},
                    {"p_value", std::exp(test.log_p)},
                    {"held_out_gain", test.held_out_gain},
                    {"verdict", test.verdict},
                    {"tied_with", test.tied_with}};
}

bool certified(const StepTest& test) {
  return test.verdict == "named" || test.verdict == "tied";
}

}  // namespace

StepFit fit_of(const Misfit& misfit, std::size_t captures) {
  return {static_cast<std::int64_t>(captures), misfit.chi2_reduced, misfit.degrees_of_freedom,
          misfit.repeatable_share, misfit.noise_floor_share};
}

void keep(const Diagnosis& diagnosis, std::size_t captures, ModelStep& step) {
  step.verdict = kolsky::name_of(diagnosis.verdict);
  step.added = diagnosis.effects;
  step.fit = fit_of(diagnosis.after, captures);
  step.held_out = {diagnosis.held_out.before, diagnosis.held_out.after, diagnosis.held_out.floor};
  step.seeds = {static_cast<double>(kSearchSeed)};
  for (const CandidateResult& candidate : diagnosis.candidates) {
    StepTest test{candidate.effect, candidate.strength,      candidate.sd,      candidate.unit,
                  candidate.log_p,  candidate.held_out_gain, candidate.verdict, {}};
    if (const auto ties = diagnosis.tied_with.find(candidate.effect);
        ties != diagnosis.tied_with.end()) {
      test.tied_with = ties->second;
    }
    step.tests.push_back(std::move(test));
  }
}

JsonValue describe(const ModelStep& step) {
  JsonObject object{
      {"action", step.action},           {"when", step.when},         {"note", step.note},
      {"data_sha256", step.data_sha256}, {"software", step.software}, {"parent", step.parent},
      {"verdict", step.verdict},         {"added", step.added},       {"seeds", step.seeds}};
  if (step.fit) {
    object.push_back({"fit", JsonObject{{"captures", step.fit->captures},
                                        {"chi2_reduced", step.fit->chi2_reduced},
                                        {"degrees_of_freedom", step.fit->degrees_of_freedom},
                                        {"repeatable_share", step.fit->repeatable_share},
                                        {"noise_floor_share", step.fit->noise_floor_share}}});
  }
  if (step.held_out) {
    object.push_back({"held_out", JsonObject{{"before", step.held_out->before},
                                             {"after", step.held_out->after},
                                             {"floor", step.held_out->floor}}});
  }
  JsonList tests;
  for (const StepTest& test : step.tests) {
    tests.push_back(describe(test));
  }
  object.push_back({"tests", std::move(tests)});
  return object;
}

std::string ledger_text(const ModelStep& step) {
  std::string text;
  if (!step.data_sha256.empty()) {
    text += fmt::format("      data {}..., kolsky {}\n", step.data_sha256.substr(0, 12),
                        step.software.empty() ? "of unknown version" : step.software);
  }
  if (step.fit) {
    text += fmt::format("      chi2 {:.4f} over {:.0f} degrees of freedom, {} captures\n",
                        step.fit->chi2_reduced, step.fit->degrees_of_freedom, step.fit->captures);
  }
  if (step.held_out) {
    const bool one_shot = step.fit && step.fit->captures == 1;
    text += fmt::format("      on held-out {} {:.4f} -> {:.4f}, noise alone {:.4f}\n",
                        one_shot ? "parts of the one record" : "shots", step.held_out->before,
                        step.held_out->after, step.held_out->floor);
  }
  for (const StepTest& test : step.tests) {
    if (!certified(test)) {
      continue;
    }
    text += fmt::format("      {} {}: {:.4g} ± {:.1g} {}, ln p {:.1f}\n", test.verdict, test.effect,
                        test.strength, test.sd, test.unit, test.log_p);
    for (const std::string& other : test.tied_with) {
      text += "        cannot be told from " + other + "\n";
    }
  }
  return text;
}

}  // namespace kolsky::cli

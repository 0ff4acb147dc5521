#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/comparison_page.hpp"
#include "clients/cli/reports/criticism_text.hpp"
#include "clients/cli/reports/diagnosis_text.hpp"
#include "clients/cli/reports/impact_criticism.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/models/diagnosis_step.hpp"
#include "drivers/files/models/model_file.hpp"
#include "drivers/files/settings/nearest_name.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/experiment/next_experiment.hpp"
#include "processing/criticism/impact/impact_diagnosis.hpp"
#include "processing/criticism/search/confirmed_hum.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"
#include "processing/criticism/verdict/examination.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  JudgedRecords judged;
  std::string model;
  std::optional<std::string> output;
  std::optional<std::string> report;
  std::optional<std::string> note;
  std::vector<std::string> without;  ///< safeguards, by name
};

JsonValue describe(const CandidateResult& candidate) {
  return JsonObject{{"effect", candidate.effect},
                    {"parameter", candidate.parameter},
                    {"unit", candidate.unit},
                    {"strength", candidate.strength},
                    {"sd", candidate.sd},
                    {"p_value", std::exp(candidate.own_log_p)},
                    {"p_value_of_search", std::exp(candidate.log_p)},
                    {"log_p", candidate.log_p},
                    {"gain", candidate.gain},
                    {"held_out_gain", candidate.held_out_gain},
                    {"smallest_detectable", candidate.detectable},
                    {"smallest_identifiable", candidate.identifiable},
                    {"nearest_rival", candidate.nearest_rival},
                    {"refitted", candidate.refitted},
                    {"per_shot", candidate.per_shot},
                    {"verdict", kolsky::name_of(candidate.verdict)}};
}

JsonObject describe(const Diagnosis& diagnosis) {
  JsonObject ties;
  for (const auto& [id, others] : diagnosis.tied_with) {
    ties.push_back({id, others});
  }
  JsonList candidates;
  for (const CandidateResult& candidate : diagnosis.candidates) {
    candidates.push_back(describe(candidate));
  }
  JsonList next;
  for (const NextExperiment& experiment : diagnosis.next_experiment) {
    next.push_back(JsonObject{{"change", experiment.change},
                              {"separates", experiment.separates},
                              {"deviations", experiment.deviations}});
  }
  const HeldOut& held_out = diagnosis.held_out;
  const auto known = [&](double value) {
    return was_reckoned(diagnosis.before) ? JsonValue(value) : JsonValue(nullptr);
  };
  return JsonObject{
      {"verdict", kolsky::name_of(diagnosis.verdict)},
      {"effects", diagnosis.effects},
      {"tied_with", std::move(ties)},
      {"misfit", JsonObject{{"before", cli::describe(diagnosis.before)},
                            {"after", cli::describe(diagnosis.after)},
                            {"held_out", JsonObject{{"before", known(held_out.before)},
                                                    {"after", known(held_out.after)},
                                                    {"floor", known(held_out.floor)}}}}},
      {"candidates", std::move(candidates)},
      {"next_experiment", std::move(next)},
      {"parameters",
       diagnosis.model ? describe_parameters(*diagnosis.model) : JsonValue(JsonObject{})},
      {"unexplained_log_p", known(diagnosis.unexplained_log_p)},
      {"notes", diagnosis.notes}};
}

/// A diagnosis, and what the model that it ends with leaves, as `compare` and `fit` have it.
struct Examined {
  Diagnosis diagnosis;
  Misfit left;
};

Examined examine_impacts(const Settings& settings, const Model& model,
                         const std::vector<Shot>& shots, const DiagnosisOptions& options) {
  const Campaign campaign = read_campaign(shots);
  require_kind(model, campaign);
  ImpactStudy study(campaign, judged_stretch(model), band_limit_of(settings.judged.band_limit_Hz),
                    all_cores());
  ImpactsSeen seen;
  Diagnosis diagnosis =
      naming_model(settings.model, [&] { return diagnose_impacts(study, model, options, &seen); });
  if (settings.report) {
    replace_file(*settings.report, render_html(impact_diagnosis_page(
                                       "What " + settings.model + " lacks",
                                       study.residuals().times_s(), model, diagnosis, seen)));
  }
  const Misfit left = diagnosis.after;
  return {std::move(diagnosis), left};
}

std::vector<std::string> safeguard_names() {
  std::vector<std::string> names;
  for (const NamedSafeguard& one : named_safeguards()) {
    names.push_back(one.name);
  }
  return names;
}

/// What was meant, or, where nothing is near, all there are.
std::string known_safeguards(const std::string& name) {
  const std::vector<std::string> names = safeguard_names();
  const std::string nearest = nearest_name(name, names);
  if (2 * edit_distance(name, nearest) <= nearest.size()) {
    return "the nearest is " + nearest + "; see kolsky diagnose --help";
  }
  std::string list;
  for (const std::string& own : names) {
    list += (list.empty() ? "" : ", ") + own;
  }
  return "give one of " + list;
}

/// All but those named.
Safeguards safeguards_without(const std::vector<std::string>& names) {
  Safeguards safeguards;
  for (const std::string& name : names) {
    const auto& all = named_safeguards();
    const auto found = std::find_if(all.begin(), all.end(),
                                    [&](const NamedSafeguard& one) { return one.name == name; });
    if (found == all.end()) {
      throw InputError("kolsky diagnose: --without", "there is no safeguard \"" + name + "\"",
                       known_safeguards(name));
    }
    safeguards.*found->member = false;
  }
  return safeguards;
}

std::string without_help() {
  std::string text =
      "for experts: leaves a safeguard out, to see what it is good for; what is claimed so is not "
      "certified. May be given again. NAME is one of";
  for (const NamedSafeguard& one : named_safeguards()) {
    text += "\n" + one.name + ": " + one.purpose;
  }
  return text;
}

Examined examine(const Settings& settings, const Model& model, const Safeguards& safeguards,
                 bool progress) {
  const std::vector<Shot> shots = read_shots(settings.judged);
  if (!shots.empty()) {
    require_model_of(shots.front().bench, model, settings.model);
  }
  if (auto verdict = verdict_without_fit(shots)) {
    if (settings.report) {
      verdict->notes.push_back("nothing was fitted, so there is no report");
    }
    return {*std::move(verdict), {}};
  }
  DiagnosisOptions options;
  options.safeguards = safeguards;
  if (progress) {
    options.progress = [](const std::string& step) { std::cerr << "kolsky: " << step << "\n"; };
  }
  if (model.kind == BenchKind::impact) {
    if (!settings.without.empty()) {
      throw InputError("kolsky diagnose: --without", "is for bars and split bars",
                       "leave it out for a ball");
    }
    return examine_impacts(settings, model, shots, options);
  }
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, band_limit_of(settings.judged.band_limit_Hz), all_cores());
  Diagnosis diagnosis =
      naming_model(settings.model, [&] { return diagnose(study, model, options); });
  diagnosis.next_experiment = next_experiments(study, diagnosis);
  if (settings.report) {
    replace_file(*settings.report, render_html(diagnosis_page("What " + settings.model + " lacks",
                                                              study, model, diagnosis)));
  }
  Misfit left;
  if (settings.output && diagnosis.model) {
    left = naming_model(settings.model, [&] {
             return judged_as_it_is(study, *diagnosis.model);
           }).misfit;
  }
  return {std::move(diagnosis), left};
}

/// The ledger, too, says what was left out.
std::string noted(const Settings& settings, const std::vector<std::string>& without) {
  std::string note = settings.note.value_or("");
  const auto add = [&note](const std::string& more) { note += (note.empty() ? "" : "; ") + more; };
  if (const std::string limits = limits_text(settings.judged); !limits.empty()) {
    add("records " + limits);
  }
  for (const std::string& name : without) {
    add("without " + name);
  }
  return note;
}

int run(const Settings& settings, Context& context) {
  ModelFile file = model_to_continue(settings.model);
  const Safeguards safeguards = safeguards_without(settings.without);
  require_model_output(settings.output);
  require_page_output(settings.report);
  auto [diagnosis, left] = examine(settings, file.model, safeguards, !context.json);
  const std::vector<std::string> without = left_out(safeguards);
  for (const std::string& name : without) {
    diagnosis.notes.push_back("without the safeguard " + name + ": nothing of this is certified");
  }
  std::string kept;
  if (settings.output && diagnosis.model) {
    add_diagnosis(file, diagnosis, left, files_of(settings.judged.captures),
                  noted(settings, without));
    kept = write_model(*settings.output, file);
  }
  if (!context.json) {
    context.out << diagnosis_text(diagnosis) << kept_text(settings.output.value_or(""), kept);
    return kDone;
  }
  JsonObject answer = describe(diagnosis);
  if (!without.empty()) {
    answer.push_back({"without", without});
  }
  add_kept(kept, answer);
  context.out << to_text(std::move(answer)) << "\n";
  return kDone;
}

}  // namespace

Command diagnose_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "diagnose";
  command.purpose =
      "finds which physical effect a model lacks\n"
      "Tests every effect of the library beside the model, refits rivals, certifies on shots that\n"
      "the fit did not see. Says what cannot be told apart, and what nothing explains.";
  command.examples =
      "  kolsky diagnose shots/*.h5 --model m.toml\n"
      "  kolsky diagnose shots --model m.toml -o m2.toml --json\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of one bench, or folders of them", &s.judged.captures),
      needed("--model", "M.toml", "the model to diagnose", &s.model),
      option("-o,--output", "M2.toml", "where to write the model with what was found, fitted",
             &s.output),
      option("--note", "TEXT", "kept in the history of the model that is written", &s.note),
      option("--report", "R.html", "a page with plots to write: one file, opens in any browser",
             &s.report),
      option("--without", "NAME", without_help(), &s.without)};
  add_judged_options(s.judged, command.arguments);
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

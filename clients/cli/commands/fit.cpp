#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/comparison_text.hpp"
#include "clients/cli/reports/criticism_text.hpp"
#include "clients/cli/reports/impact_criticism.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/models/diagnosis_step.hpp"
#include "processing/criticism/search/confirmed_hum.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  JudgedRecords judged;
  std::string model;
  std::string output;
  std::optional<std::string> note;
};

Studied fit(const Settings& settings, const Model& model, const Campaign& campaign,
            const Workers& executor) {
  const double band_limit_Hz = band_limit_of(settings.judged.band_limit_Hz);
  if (model.kind == BenchKind::impact) {
    require_kind(model, campaign);
    ImpactStudy study(campaign, judged_stretch(model), band_limit_Hz, executor);
    return naming_model(settings.model, [&] { return study.settled(study.fit(model)); });
  }
  Study study(campaign, band_limit_Hz, executor);
  return naming_model(settings.model, [&] { return judged(study, study.fit(model)); });
}

int run(const Settings& settings, Context& context) {
  ModelFile file = model_to_continue(settings.model);
  require_model_output(settings.output);
  const Workers workers = all_cores();
  const Campaign campaign = read_campaign(read_shots(settings.judged));
  require_model_of(campaign.bench, file.model, settings.model);
  const Studied studied = fit(settings, file.model, campaign, workers);
  const std::string limits = limits_text(settings.judged);
  begin_step(file, fmt::format("fit {} captures{}", campaign.shots.size(),
                               limits.empty() ? "" : " " + limits));
  file.history.back().data_sha256 = digest_of_files(files_of(settings.judged.captures));
  file.history.back().fit = fit_of(studied.misfit, campaign.shots.size());
  file.history.back().note = settings.note.value_or("");
  file.model = studied.model;
  file.gauges = gauges_of(campaign.bench);
  const std::string kept = write_model(settings.output, file);
  // What an impact leaves a calculation may leave, too.
  const std::optional<std::string> doubtful =
      file.model.kind == BenchKind::impact
          ? std::nullopt
          : doubtful_numbers_text(studied.misfit, campaign.shots.size());
  if (context.json) {
    JsonObject answer{{"model", settings.output},
                      {"parameters", describe_parameters(file.model)},
                      {"misfit", describe(studied.misfit)},
                      {"effects", describe_effects(file.model)},
                      {"strained", describe_strained(file.model)},
                      {"at_bounds", describe_bounds(file.model)},
                      {"converged", studied.fit.converged},
                      {"notes", doubtful ? JsonList{*doubtful} : JsonList{}},
                      {"parent", file.parent()}};
    add_kept(kept, answer);
    context.out << to_text(answer) << "\n";
    return kDone;
  }
  context.out << kept_text(settings.output, kept) << settings.output << "\n"
              << model_table(file.model) << misfit_text(studied.misfit)
              << in_words(studied.misfit, campaign.shots.size()) << "\n"
              << strained_text(file.model) << bounds_text(file.model)
              << (doubtful ? "note: " + *doubtful + "\n" : "");
  return kDone;
}

}  // namespace

Command fit_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "fit";
  command.purpose =
      "fits a model to captures\n"
      "On bars every shot's source is free; of an impact the force is calculated, and each shot's\n"
      "arrival and offset are free. Filed deviations bound what may move besides.";
  command.examples = "  kolsky fit shots/*.h5 --model m.toml -o m2.toml\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of one bench, or folders of them", &s.judged.captures),
      needed("--model", "M.toml", "the model to fit", &s.model),
      needed("-o,--output", "M2.toml", "where the fitted model goes", &s.output),
      option("--note", "TEXT", "kept in the model's history", &s.note)};
  add_judged_options(s.judged, command.arguments);
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

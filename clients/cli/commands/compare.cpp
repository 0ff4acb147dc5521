#include <algorithm>
#include <iterator>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/comparison_page.hpp"
#include "clients/cli/reports/comparison_text.hpp"
#include "clients/cli/reports/criticism_text.hpp"
#include "clients/cli/reports/impact_criticism.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "processing/criticism/impact/impact_notes.hpp"
#include "processing/criticism/records/arrival_order.hpp"
#include "processing/criticism/search/confirmed_hum.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  JudgedRecords judged;
  std::string model;
  bool fit = false;
  std::optional<std::string> report;
};

bool was_fitted(const ModelFile& file) {
  return std::any_of(file.history.begin(), file.history.end(),
                     [](const ModelStep& step) { return !step.data_sha256.empty(); });
}

/// Effects of which every shot or gauge has a strength of its own; empty where there are none.
std::string own_strengths(const Model& model) {
  std::string list;
  for (const EffectUse& use : model.effects) {
    list += has_own_strengths(use) ? (list.empty() ? "" : ", ") + use.id() : "";
  }
  return list;
}

/// What was done to the model before it was compared, for people.
std::string how(const Settings& settings, const ModelFile& file) {
  if (settings.fit) {
    return "fitted to these captures first, as asked; the model file stays as it is";
  }
  if (!was_fitted(file)) {
    return "the model was never fitted: fitted to these captures first; the model file stays as "
           "it is";
  }
  std::string text = "as it is in the file";
  if (file.history.back().data_sha256.empty()) {
    text += ", which was changed after its last fit: `kolsky fit`, or --fit here";
  }
  const auto captures = files_of(settings.judged.captures);
  const auto fitted = std::find_if(file.history.rbegin(), file.history.rend(),
                                   [](const ModelStep& step) { return !step.data_sha256.empty(); });
  if (!is_digest_of(fitted->data_sha256, captures)) {
    text +=
        "; it was fitted to other captures than just these: what it has of gauges and bars is "
        "theirs";
  }
  if (const std::string own = own_strengths(file.model); !own.empty()) {
    text +=
        "; fitted to these captures, as a model keeps but their mean: each shot's or gauge's "
        "own strengths of " +
        own;
  }
  return text;
}

/// All but the first, a line each.
std::string further_notes(const std::vector<std::string>& notes) {
  std::string text;
  for (std::size_t i = 1; i < notes.size(); ++i) {
    text += "  note: " + notes[i] + "\n";
  }
  return text;
}

int run_impacts(const Settings& settings, const ModelFile& file, const Campaign& campaign,
                Context& context) {
  require_kind(file.model, campaign);
  ImpactStudy study(campaign, judged_stretch(file.model),
                    band_limit_of(settings.judged.band_limit_Hz), all_cores());
  const bool fit_first = settings.fit || !was_fitted(file);
  const Studied studied = naming_model(settings.model, [&] {
    return fit_first ? study.fit(file.model) : study.as_it_is(file.model);
  });
  const ImpactComparison comparison = study.compare(studied);
  std::vector<std::string> notes = not_constrained(study, studied);
  std::ranges::move(misfiled_gauges(campaign), std::back_inserter(notes));
  for (auto& note : {scatter_doubt(study, studied), quiet_note(studied)}) {
    if (note) {
      notes.push_back(*note);
    }
  }
  notes.insert(notes.begin(), how(settings, file));
  if (settings.report) {
    replace_file(*settings.report,
                 render_html(impact_page(settings.model + " against the measurements", notes,
                                         comparison, study, studied)));
  }
  if (context.json) {
    context.out << to_text(JsonObject{{"model", settings.model},
                                      {"misfit", describe(studied.misfit)},
                                      {"calculation_allowance", name_of(study.allowance(studied))},
                                      {"where", describe_tiles(comparison, campaign)},
                                      {"speeds", describe_speeds(comparison)},
                                      {"fitted_first", fit_first},
                                      {"converged", studied.fit.converged},
                                      {"parameters", describe_parameters(studied.model)},
                                      {"effects", describe_effects(studied.model)},
                                      {"strained", describe_strained(studied.model)},
                                      {"notes", notes}})
                << "\n";
    return kDone;
  }
  context.out << settings.model << ": " << notes.front() << "\n"
              << misfit_text(studied.misfit) << impact_words(study, studied) << "\n"
              << strained_text(studied.model) << "\n"
              << speeds_table(comparison) << "\n"
              << places_table(comparison, campaign)
              << (is_strained(studied.model)
                      ? "  filed numbers are strained to that end beyond three deviations\n"
                      : "")
              << "\n"
              << worst_plot(comparison, study.residuals().times_s(), context.terminal)
              << further_notes(notes);
  return kDone;
}

int run(const Settings& settings, Context& context) {
  const ModelFile file = model_named(settings.model);
  require_page_output(settings.report);
  const Campaign campaign = read_campaign(read_shots(settings.judged));
  require_model_of(campaign.bench, file.model, settings.model);
  if (file.model.kind == BenchKind::impact) {
    return run_impacts(settings, file, campaign, context);
  }
  Study study(campaign, band_limit_of(settings.judged.band_limit_Hz), all_cores());
  const bool fit_first = settings.fit || !was_fitted(file);
  const Studied studied = naming_model(settings.model, [&] {
    return fit_first ? judged(study, study.fit(file.model)) : judged_as_it_is(study, file.model);
  });
  Comparer comparer(study.residuals(), studied.composition, studied.fit.theta);
  const Comparison comparison = comparer.compare(studied.fit.residual, studied.misfit);
  const ShotGroups groups = by_strength(comparison, studied.model, campaign);
  std::vector<std::string> notes{how(settings, file)};
  std::ranges::move(misfiled_gauges(campaign), std::back_inserter(notes));
  if (settings.report) {
    replace_file(*settings.report,
                 render_html(comparison_page(settings.model + " against the measurements", notes,
                                             study, studied, comparer, comparison)));
  }
  if (context.json) {
    context.out << to_text(JsonObject{{"model", settings.model},
                                      {"misfit", describe(studied.misfit)},
                                      {"where", describe_tiles(comparison, campaign)},
                                      {"regions", describe_regions(comparison, campaign)},
                                      {"by_strength", describe_strengths(groups, campaign)},
                                      {"places", describe_places(comparison, comparer, study)},
                                      {"fitted_first", fit_first},
                                      {"converged", studied.fit.converged},
                                      {"parameters", describe_parameters(studied.model)},
                                      {"effects", describe_effects(studied.model)},
                                      {"strained", describe_strained(studied.model)},
                                      {"notes", notes}})
                << "\n";
    return kDone;
  }
  const std::string strengths = fails_anywhere(comparison) ? strengths_table(groups, campaign) : "";
  context.out << settings.model << ": " << notes.front() << "\n"
              << further_notes(notes) << misfit_text(studied.misfit)
              << in_words(studied.misfit, campaign.shots.size()) << "\n"
              << strained_text(studied.model) << "\n"
              << (fails_anywhere(comparison)
                      ? places_table(comparison, campaign)
                      : "  " + nothing_fails_words(studied.model, studied.misfit) + "\n")
              << "\n"
              << (strengths.empty() ? "" : strengths + "\n")
              << worst_plot(comparison, comparer, study, studied.fit.residual, context.terminal);
  return kDone;
}

}  // namespace

Command compare_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "compare";
  command.purpose =
      "shows where a model fails: gauge, arrival window, frequency band, shot\n"
      "Residuals in units of the measured noise. What repeats from shot to shot is the model's "
      "fault;\n"
      "what does not is a shot's own, or follows what shots differ by, as amplitude or "
      "temperature.\n"
      "A model that was never fitted is fitted first.";
  command.examples =
      "  kolsky compare shots/*.h5 --model m.toml\n"
      "  kolsky compare shots --model m.toml --report where.html\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of one bench, or folders of them", &s.judged.captures),
      needed("--model", "M.toml", "the model to compare, or M.toml@N", &s.model),
      flag("--fit", "fit the model to these captures first; the file stays as it is", &s.fit),
      option("--report", "R.html", "a page with plots to write: one file, opens in any browser",
             &s.report)};
  add_judged_options(s.judged, command.arguments);
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

#include <algorithm>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/impact_criticism.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/reports/waterfall_text.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "processing/criticism/waterfall/impact_waterfall.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  std::string model;
  JudgedRecords judged;
  std::optional<std::string> report;
  std::optional<std::string> svg;
};

/// Effects in the order in which the ledger has them come in.
std::vector<std::string> order_of(const ModelFile& file) {
  std::vector<std::string> order;
  for (const ModelStep& step : file.history) {
    order.insert(order.end(), step.added.begin(), step.added.end());
  }
  return order;
}

std::vector<std::string> notes_of(const Settings& settings, const ModelFile& file,
                                  const Waterfall& fall) {
  std::vector<std::string> notes;
  const auto captures = files_of(settings.judged.captures);
  const bool seen =
      std::any_of(file.history.begin(), file.history.end(),
                  [&](const ModelStep& step) { return is_digest_of(step.data_sha256, captures); });
  notes.emplace_back(
      seen ? "the captures that the model's ledger names; every model of the lineage "
             "is fitted to them again, under one measure of the noise"
      : file.history.empty() ? "the model has taken no steps yet; it is fitted to these captures"
                             : "not the captures that the model's ledger names: every model of the "
                               "lineage is fitted to these");
  if (fall.fold == "parts") {
    notes.emplace_back(
        "one shot: held out are parts of its record, not shots; repeat the shot to certify");
  } else if (fall.folds < 2) {
    notes.emplace_back("one shot: nothing is held out; repeat the shot to certify");
  }
  if (fall.steps.size() == 1) {
    notes.emplace_back("the model holds no effect that its first model did not hold");
  }
  return notes;
}

Waterfall fall_of(const Settings& settings, const ModelFile& file) {
  const Campaign campaign = read_campaign(read_shots(settings.judged));
  require_model_of(campaign.bench, file.model, settings.model);
  const double band_limit_Hz = band_limit_of(settings.judged.band_limit_Hz);
  const std::vector<LineageStep> steps = lineage(file.at(0).model, file.model, order_of(file));
  if (file.model.kind == BenchKind::impact) {
    require_kind(file.model, campaign);
    const bool whole = std::any_of(steps.begin(), steps.end(), [](const LineageStep& step) {
      return judged_stretch(step.model) == JudgedStretch::whole;
    });
    ImpactStudy study(campaign, whole ? JudgedStretch::whole : JudgedStretch::to_reflection,
                      band_limit_Hz, all_cores());
    return naming_model(settings.model, [&] { return waterfall(study, steps); });
  }
  Study study(campaign, band_limit_Hz, all_cores());
  return waterfall(study, steps);
}

int run(const Settings& settings, Context& context) {
  const ModelFile file = model_named(settings.model);
  require_page_output(settings.report);
  require_picture_output(settings.svg);
  const Waterfall fall = fall_of(settings, file);
  const std::vector<std::string> notes = notes_of(settings, file, fall);
  const std::string title = "How the misfit of " + settings.model + " fell";
  if (settings.report) {
    replace_file(*settings.report, render_html(waterfall_page(fall, title, notes)));
  }
  if (settings.svg) {
    replace_file(*settings.svg, cascade_svg(cascade_of(fall, title)));
  }
  if (context.json) {
    JsonObject object = std::get<JsonObject>(describe(fall).content());
    object.insert(object.begin(), {"model", settings.model});
    object.push_back({"notes", notes});
    context.out << to_text(std::move(object)) << "\n";
    return kDone;
  }
  context.out << settings.model << ": " << notes.front() << "\n"
              << waterfall_text(fall, context.terminal);
  for (std::size_t i = 1; i < notes.size(); ++i) {
    context.out << "  note: " << notes[i] << "\n";
  }
  return kDone;
}

}  // namespace

Command model_waterfall_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "model waterfall";
  command.purpose =
      "how the misfit fell, effect by effect, from a model's first form to the noise\n"
      "Every model of the lineage is fitted to the captures; drops are those on shots that the "
      "fits "
      "did\nnot see. Then how the moduli moved and, beside a specimen, its stress-strain curve. Of "
      "a "
      "ball\nwhole speeds are held out, and the force's error at every speed is told.";
  command.examples =
      "  kolsky model waterfall m2.toml shots/*.h5\n"
      "  kolsky model waterfall m2.toml shots --report fall.html --svg fall.svg\n";
  command.arguments = {
      needed("MODEL", "", "the model file, with its lineage, or M.toml@N", &s.model),
      needed("CAPTURE", "", "captures of one bench, or folders of them", &s.judged.captures),
      option("--report", "R.html", "a page with the picture to write: one file, opens anywhere",
             &s.report),
      option("--svg", "FILE", "the picture alone", &s.svg)};
  add_judged_options(s.judged, command.arguments);
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

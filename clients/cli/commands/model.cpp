#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <ostream>
#include <sstream>
#include <utility>

#include "clients/cli/command.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/reports/impact_criticism.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "drivers/files/models/model_file.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/settings/toml_table.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/impact/bench_impact.hpp"
#include "processing/models/material_effects.hpp"

namespace kolsky::cli {
namespace {

/// @param kept  where the model now is that had this name before, if there was one
void print(const ModelFile& file, const std::string& name, Context& context,
           const std::string& kept) {
  if (context.json) {
    JsonObject object{{"model", name},
                      {"kind", name_of(file.model.kind)},
                      {"effects", describe_effects(file.model)},
                      {"parameters", describe_parameters(file.model)},
                      {"parent", file.parent()},
                      {"edited_by_hand", file.edited_by_hand}};
    add_kept(kept, object);
    context.out << to_text(object) << "\n";
    return;
  }
  context.out << kept_text(name, kept) << name << ": " << name_of(file.model.kind) << ", "
              << counted(file.model.effects.size(), "effect")
              << (file.edited_by_hand ? "; " + edited_text(file) : "") << "\n"
              << (file.bar_source.empty()
                      ? ""
                      : (file.model.kind == BenchKind::impact ? "  " : "  bars: ") +
                            file.bar_source + "\n")
              << model_table(file.model);
}

struct NewSettings {
  std::optional<std::string> kind;  ///< else the bench's
  std::optional<std::string> bench;
  std::optional<std::string> bar_model;
  std::optional<std::string> core;
  std::optional<std::string> cover;
  std::optional<std::string> reading;
  std::string output;
};

/// A model has one material for all viscoelastic bars.
void refuse_own_material(const Bench& bench, const std::string& file) {
  if (bench.output && bench.output->material) {
    throw InputError(file + ": bars.output.material",
                     "is filed, and a model has one material for all viscoelastic bars",
                     "leave it out where both are of one, or reduce and identify with the bench as "
                     "it is");
  }
}

/// Bars that are held as the paper's PMMA must be near enough to it.
void require_assumable(const Bench& bench, const std::string& file) {
  try {
    static_cast<void>(assumed_bars(bench));
  } catch (const InputError& error) {
    throw error.inside(file);
  }
}

/// Bars as a material file gives them: where a model of the bar itself starts, what one of a split
/// bar goes by.
void take_bar_model(const Material& material, const std::optional<Bench>& bench, Model& model) {
  EffectUse* bars = model.find("three-element-bar");
  if (bars == nullptr) {
    return;
  }
  const Material three = three_elements_of(material);
  const bool starts_only = model.kind != BenchKind::shpb;
  if (starts_only) {
    for (std::size_t p = 0; p < three.parameters.size(); ++p) {
      bars->values[p].value = bars->values[p].prior_mean = three.parameters[p].value;
    }
  } else {
    take_bars(three, *bars);
  }
  if (auto further = further_effect(material, "")) {
    if (bench) {
      require_for_all_bars(*further, material, *bench);
    }
    for (ModelValue& value : further->values) {
      value.free = starts_only;
    }
    add_behind("three-element-bar", std::move(*further), model);
  }
}

void take_ball_layer(const Material& material, const std::string& layer, Model& model) {
  take_layer(three_elements_of(material), *model.find("three-element-" + layer));
  if (auto further = further_effect(material, layer + "-")) {
    add_behind("three-element-" + layer, std::move(*further), model);
  }
}

/// What a model takes of a material file, with the file in what it refuses.
template <class Take>
void take_from(const std::string& file, const Take& take) {
  try {
    take();
  } catch (const InputError& error) {
    throw TomlTable::open(file).located(error);
  }
}

/// Core, cover and reading of a ball, and a line on where they come from.
std::string take_ball(const NewSettings& settings, const std::optional<Bench>& bench,
                      Model& model) {
  std::array<Material, 2> materials{paper_golf_core(), paper_golf_cover()};
  std::string source;
  const std::array<const std::optional<std::string>*, 2> files{&settings.core, &settings.cover};
  const std::array<const char*, 2> names{"core", "cover"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    source += (i == 0 ? "" : "; ") + std::string(names.at(i)) + ": ";
    if (*files.at(i)) {
      materials.at(i) = read_material(**files.at(i));
      take_from(**files.at(i), [&] { take_ball_layer(materials.at(i), names.at(i), model); });
      source += **files.at(i);
    } else {
      source += materials.at(i).source + ", held";
    }
  }
  if (settings.reading) {
    model.find("three-dimensional-reading")->values[0].value =
        static_cast<double>(impact::reading_named(*settings.reading, "--reading"));
  }
  if (bench) {
    // What a mass or a solid keeps from being calculated is said now.
    try {
      static_cast<void>(impact::impact_on(*bench, {materials[0]}, {materials[1]},
                                          impact::TargetKind::dashpot, 1.0));
    } catch (const InputError& error) {
      throw error.inside(*settings.bench);
    }
  }
  return source;
}

/// As given, or as the bench has it.
BenchKind kind_of(const NewSettings& settings, const std::optional<Bench>& filed) {
  if (!settings.kind && !filed) {
    throw InputError("--kind", "is missing, and no bench file says it",
                     "give --kind bar, shpb or impact, or --bench B.toml");
  }
  const BenchKind kind = settings.kind ? bench_kind(*settings.kind) : filed->kind;
  if (filed && filed->kind != kind) {
    throw InputError(*settings.bench + ": kind",
                     "is \"" + name_of(filed->kind) + "\" and --kind is " + *settings.kind,
                     "give --kind " + name_of(filed->kind));
  }
  return kind;
}

int make_new(const NewSettings& settings, Context& context) {
  ModelFile file;
  std::optional<Bench> filed;
  if (settings.bench) {
    filed = read_bench(*settings.bench).bench;
  }
  const BenchKind kind = kind_of(settings, filed);
  bool elastic = kind == BenchKind::impact;
  if (kind != BenchKind::impact && (settings.core || settings.cover || settings.reading)) {
    throw InputError("--core, --cover, --reading", "belong to a ball",
                     "leave them out, or give --kind impact");
  }
  if (filed) {
    refuse_own_material(*filed, *settings.bench);
    elastic = filed->input.youngs_modulus_Pa.has_value() &&
              (!filed->output || filed->output->youngs_modulus_Pa.has_value());
    file.gauges = gauges_of(*filed);
  }
  file.model = paper_model(kind, elastic);
  if (kind == BenchKind::impact) {
    if (settings.bar_model) {
      throw InputError("--bar-model", "belongs to viscoelastic bars; a ball strikes an elastic one",
                       "leave it out");
    }
    file.bar_source = take_ball(settings, filed, file.model);
  } else if (settings.bar_model) {
    const Material bars = read_material(*settings.bar_model);
    require_passive(bars, *settings.bar_model);
    // A bar's own model only starts there.
    if (kind == BenchKind::shpb && filed) {
      require_bar_model_holds(bars, *filed, *settings.bar_model);
    }
    take_from(*settings.bar_model, [&] { take_bar_model(bars, filed, file.model); });
    file.bar_source = *settings.bar_model;
  } else if (!elastic) {
    if (kind == BenchKind::shpb && filed) {
      require_assumable(*filed, *settings.bench);
    }
    file.bar_source = kind == BenchKind::bar ? "starts from the paper's PMMA (Table 4, row 1)"
                                             : "the paper's PMMA (Table 4, row 1), held";
  }
  print(file, settings.output, context, write_model(settings.output, file));
  return kDone;
}

struct EditSettings {
  std::string model;
  std::string effect;
  std::optional<std::string> output;
  bool per_shot = false;
  bool shared = false;
  std::optional<std::string> note;
  std::optional<std::uint64_t> to;  ///< of a reversion: a step
};

/// What is kept with a step: a line or a few, as a file's lines are bounded.
std::string note_of(const EditSettings& settings) {
  constexpr std::size_t kLongest = 1000;
  const std::string note = settings.note.value_or("");
  if (note.size() > kLongest) {
    throw InputError("--note", "is longer than " + std::to_string(kLongest) + " bytes",
                     "shorten it, or name the file that says more");
  }
  return note;
}

void require_its_gauge(const EffectUse& use, const ModelFile& file) {
  if (use.gauge.empty() || file.gauges.empty() ||
      std::ranges::find(file.gauges, use.gauge) != file.gauges.end()) {
    return;
  }
  throw InputError("effect " + use.id(),
                   "names a gauge that the model's bench does not have: its gauges are " +
                       fmt::format("{}", fmt::join(file.gauges, ", ")),
                   "give one of these, as in " + use.effect->about().id + ":" +
                       file.gauges.front() +
                       ", or fit the model to captures of the bench that has it");
}

/// A number of the bench, not what is only bounded by a prior, as a hum's amplitudes are.
bool is_filed(const EffectUse& use) {
  const EffectAbout& about = use.effect->about();
  return !about.base && !about.each_gauge &&
         std::any_of(use.values.begin(), use.values.end(),
                     [](const ModelValue& value) { return value.prior_sd > 0.0 && value.free; });
}

/// Adds an effect, or frees a number that the bench files of what is filed: claimed beside the
/// records' own word for it, that is what it takes. @return the effect as it stands in the model
EffectUse put_in(ModelFile& file, EffectUse use, const EditSettings& settings) {
  EffectUse* held = file.model.find(use.id());
  if (held == nullptr) {
    use.per_shot = settings.per_shot;
    use.form_open = use.effect->about().per_shot && !settings.per_shot && !settings.shared;
    file.model.effects.push_back(use);
    return use;
  }
  if (!is_filed(*held) || settings.per_shot) {
    throw InputError(settings.model + ": effect " + use.id(), "is in the model already",
                     "fit it, or remove it first");
  }
  for (ModelValue& value : held->values) {
    value.prior_sd = 0.0;
  }
  held->prior_correlation.clear();
  return *held;
}

int add(const EditSettings& settings, Context& context) {
  ModelFile file = model_to_continue(settings.model);
  EffectUse use = use_named(settings.effect, file.model);
  require_its_gauge(use, file);
  const auto& kinds = use.effect->about().kinds;
  if (std::find(kinds.begin(), kinds.end(), file.model.kind) == kinds.end()) {
    throw InputError("effect " + use.id(),
                     "does not belong to a bench of kind " + name_of(file.model.kind),
                     "`kolsky effects` lists what does");
  }
  if (settings.per_shot && !use.effect->about().per_shot) {
    throw InputError("effect " + use.id(), "is one for all shots", "leave --per-shot out");
  }
  if (settings.per_shot && settings.shared) {
    throw InputError("--shared", "and --per-shot exclude each other", "give one of them, or none");
  }
  const bool freed = file.model.find(use.id()) != nullptr;
  begin_step(file, "add " + use.id());
  file.history.back().added = {use.id()};
  file.history.back().note = note_of(settings);
  use = put_in(file, std::move(use), settings);
  const std::string output = settings.output.value_or(settings.model);
  const std::string kept = write_model(output, file);
  if (context.json) {
    print(file, output, context, kept);
    return kDone;
  }
  context.out
      << kept_text(output, kept) << output
      << (freed ? ": freed of what the bench files, to be fitted; " : ": added, to be fitted; ")
      << counted(file.model.effects.size(), "effect") << "\n"
      << effect_text(use)
      << (use.form_open ? "      of all shots, or each shot's own: the next fit settles it\n" : "");
  return kDone;
}

int remove(const EditSettings& settings, Context& context) {
  ModelFile file = model_to_continue(settings.model);
  const EffectUse* use = file.model.find(settings.effect);
  if (use == nullptr) {
    throw InputError(settings.model + ": effect " + settings.effect, "is not in the model",
                     "`kolsky model show` lists what is");
  }
  if (is_filed(*use)) {
    throw InputError(settings.model + ": effect " + settings.effect,
                     "is a number that the bench files within a deviation: every fit to its "
                     "captures takes it in again",
                     "to hold it where it is, write `free = false` for it in the model file; to "
                     "free it of what is filed, take `prior_sd` and `prior_mean` out there");
  }
  constexpr std::array<const char*, 5> kNeeded{"elementary-waves", "three-element-bar",
                                               "three-element-specimen", "three-element-core",
                                               "three-element-cover"};
  if (std::ranges::find(kNeeded, settings.effect) != kNeeded.end()) {
    throw InputError(settings.model + ": effect " + settings.effect,
                     "is what a model foretells with: without it there is nothing to compare",
                     "add effects beside it; `kolsky model new` begins another model");
  }
  begin_step(file, "remove " + settings.effect);
  file.history.back().note = note_of(settings);
  std::erase_if(file.model.effects,
                [&](const EffectUse& own) { return own.id() == settings.effect; });
  const std::string output = settings.output.value_or(settings.model);
  print(file, output, context, write_model(output, file));
  return kDone;
}

int show(const EditSettings& settings, Context& context) {
  print(model_named(settings.model), settings.model, context, "");
  return kDone;
}

std::string changes(const Model& before, const Model& after) {
  std::string text;
  for (const Declared& own : declared_anew(before, after)) {
    text += "      " + own.text() + "\n";
  }
  for (const EffectUse& use : after.effects) {
    const EffectUse* old = before.find(use.id());
    if (old == nullptr) {
      text += "      + " + use.id() + "\n";
      continue;
    }
    for (std::size_t p = 0; p < std::min(use.values.size(), old->values.size()); ++p) {
      if (use.values[p].value != old->values[p].value) {
        const EffectParameter& parameter = use.effect->about().parameters[p];
        text += fmt::format("        {}.{}: {} -> {}\n", use.id(), parameter.name,
                            number_text(old->values[p].value, old->values[p].sd, parameter.unit),
                            number_text(use.values[p].value, use.values[p].sd, parameter.unit));
      }
    }
  }
  for (const EffectUse& use : before.effects) {
    if (after.find(use.id()) == nullptr) {
      text += "      - " + use.id() + "\n";
    }
  }
  return text;
}

/// Under a step's line, each line of it.
std::string indented(const std::string& note) {
  std::string text;
  std::istringstream lines(note);
  for (std::string line; std::getline(lines, line);) {
    text += "      " + line + "\n";
  }
  return text;
}

int history(const EditSettings& settings, Context& context) {
  const ModelFile file = model_to_continue(settings.model);
  if (context.json) {
    JsonList steps;
    for (const ModelStep& step : file.history) {
      JsonObject own = std::get<JsonObject>(describe(step).content());
      own.push_back({"effects_before", describe_effects(file.at(steps.size()).model)});
      steps.push_back(std::move(own));
    }
    context.out << to_text(JsonObject{{"history", std::move(steps)},
                                      {"effects", describe_effects(file.model)},
                                      {"parent", file.parent()},
                                      {"edited_by_hand", file.edited_by_hand}})
                << "\n";
    return kDone;
  }
  for (std::size_t i = 0; i < file.history.size(); ++i) {
    const ModelStep& step = file.history[i];
    const Model before = file.at(i).model;
    const Model after = file.at(i + 1).model;
    context.out << fmt::format("{:>3}  {}  {}\n", i + 1, step.when, step.action)
                << indented(step.note) << ledger_text(step) << changes(before, after);
  }
  if (file.edited_by_hand) {
    context.out << "     " << edited_text(file) << ", which lists that with its own\n";
  }
  if (file.history.empty()) {
    context.out << "no steps yet\n";
  }
  return kDone;
}

/// To how many steps a model goes back: before the last that was not itself a going back.
std::size_t target_of(const EditSettings& settings, const ModelFile& file) {
  if (settings.to) {
    return *settings.to;
  }
  const std::size_t now = file.first_alike(file.history.size());
  if (now == 0) {
    throw InputError(settings.model, "is as it began: there is no step to go back to",
                     "nothing needs to be done; --to goes to any step of the history");
  }
  return now - 1;
}

int revert(const EditSettings& settings, Context& context) {
  ModelFile file = model_to_continue(settings.model);
  const std::size_t target = target_of(settings, file);
  const ModelFile before = naming_model(settings.model, [&] { return file.at(target); });
  begin_step(file, fmt::format("revert to step {}", target));
  file.history.back().note = note_of(settings);
  file.model = before.model;
  file.gauges = before.gauges;
  const std::string output = settings.output.value_or(settings.model);
  print(file, output, context, write_model(output, file));
  return kDone;
}

Command edit_command(const std::string& name, const std::string& purpose,
                     const std::string& examples, int (*run)(const EditSettings&, Context&),
                     bool needs_effect, bool writes) {
  auto settings = std::make_shared<EditSettings>();
  EditSettings& s = *settings;
  Command command;
  command.name = "model " + name;
  command.purpose = purpose;
  command.examples = examples;
  command.arguments = {needed(
      "MODEL", "", name == "show" ? "the model file, or M.toml@N" : "the model file", &s.model)};
  if (needs_effect) {
    command.arguments.push_back(
        needed("EFFECT", "", "its id, as `kolsky effects` lists it", &s.effect));
  }
  if (writes) {
    command.arguments.push_back(
        option("-o,--output", "M2.toml", "where to write; else the model file itself", &s.output));
    command.arguments.push_back(option("--note", "TEXT", "kept in the model's history", &s.note));
  }
  if (name == "add") {
    command.arguments.push_back(
        flag("--per-shot",
             "with a strength of its own for every shot (a drift, a hum); else the next fit finds "
             "whether that takes it",
             &s.per_shot));
    command.arguments.push_back(flag("--shared", "with one strength for all shots", &s.shared));
  }
  if (name == "revert") {
    command.arguments.push_back(
        option("--to", "N", "as it was after N steps, 0: as it began; else one step back", &s.to));
  }
  command.run = [settings, run](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace

Command model_new_command() {
  auto settings = std::make_shared<NewSettings>();
  NewSettings& s = *settings;
  Command command;
  command.name = "model new";
  command.purpose =
      "the paper's model of a bench, where every comparison starts\n"
      "A bar: three-element material, elementary waves, ideal ends and sensors; moduli free. A "
      "split\n"
      "bar: its bars as given, a massless three-element specimen, free outer ends. A ball: linear "
      "core\n"
      "and cover, held but for what their files give a deviation or covariance, friction 0.3 "
      "within\n"
      "0.1, an endless bar.";
  command.examples =
      "  kolsky model new --bench bench.toml -o m.toml\n"
      "  kolsky model new --kind shpb --bench bench.toml --bar-model pmma.toml -o m.toml\n"
      "  kolsky model new --kind impact -o m.toml\n";
  Argument kind = option("--kind", "KIND",
                         "of the bench: bar, shpb or impact; else as its file has it", &s.kind);
  kind.choices = {"bar", "shpb", "impact"};
  command.arguments = {
      kind,
      option("--bench", "B.toml", "bench file: tells its gauges and whether its bars are elastic",
             &s.bench),
      option("--bar-model", "M.toml", "material file of viscoelastic bars; else the paper's PMMA",
             &s.bar_model),
      option("--core", "C.toml", "material file of a ball's core; else the paper's", &s.core),
      option("--cover", "V.toml", "material file of a ball's cover; else the paper's", &s.cover),
      option("--reading", "R",
             "of the ball's uniaxial law in three dimensions: full, bulk-E1, bulk-Einf or exact",
             &s.reading),
      needed("-o,--output", "M.toml", "the model file to write", &s.output)};
  command.run = [settings](Context& context) { return make_new(*settings, context); };
  return command;
}

Command model_add_command() {
  return edit_command("add",
                      "adds an effect to a model, at the value at which it is not there yet\n"
                      "A fit then finds its strength.",
                      "  kolsky model add m.toml geometric-dispersion -o m2.toml\n"
                      "  kolsky model add m.toml gauge-position:g3\n",
                      add, true, true);
}

Command model_remove_command() {
  return edit_command("remove", "takes an effect out of a model\nIts history keeps it.",
                      "  kolsky model remove m.toml crosstalk:g2\n", remove, true, true);
}

Command model_show_command() {
  return edit_command("show", "what a model holds\nEffects by stage, with their numbers.",
                      "  kolsky model show m.toml\n", show, false, false);
}

Command model_history_command() {
  return edit_command("history",
                      "a model's lineage: every step, what it changed and on which data\n"
                      "Nothing that a model once was is lost: `kolsky model revert` goes back.",
                      "  kolsky model history m.toml\n", history, false, false);
}

Command model_revert_command() {
  return edit_command("revert",
                      "undoes a model's last step, or all down to one\n"
                      "Steps and their undoing stay in the history; undone twice, two are undone.",
                      "  kolsky model revert m.toml\n"
                      "  kolsky model revert m.toml --to 0\n",
                      revert, false, true);
}

}  // namespace kolsky::cli

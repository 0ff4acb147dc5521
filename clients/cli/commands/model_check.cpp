#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/models/model_file.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/verdict/distinction.hpp"
#include "processing/models/admission.hpp"
#include "processing/models/physics.hpp"
#include "processing/models/transfers.hpp"

namespace kolsky::cli {
namespace {

constexpr std::size_t kPlaces = 2048;
constexpr std::size_t kRivalsShown = 4;
constexpr double kSlow = 10.0;  ///< times the model without the expression

struct Settings {
  std::string model;
  JudgedRecords judged;
};

/// One expression, checked.
struct Checked {
  const ExpressionEffect* effect = nullptr;
  bool used = false;
  double time_s = 0.0;
  double times_model = 1.0;  ///< what an evaluation takes, of that of the model without it

  [[nodiscard]] bool slow() const { return times_model > kSlow; }
  std::vector<Distinction> distinctions;  ///< by gauge, for effects of one gauge
};

/// What a model without its expressions is, along a path of ordinary length on a bench of ordinary
/// size: the paper's effects and those that it holds of the library.
class Stopwatch {
 public:
  explicit Stopwatch(const Model& model) : bench_(admission_bench(model.kind)) {
    for (std::size_t k = 0; k < kPlaces; ++k) {
      path_.emplace_back(4000.0, 2.0 * std::numbers::pi * 100.0 * static_cast<double>(k));
    }
    for (const EffectUse& use : paper_model(model.kind, false).effects) {
      add(model.find(use.id()) != nullptr ? *model.find(use.id()) : use);
    }
    for (const EffectUse& use : model.effects) {
      const auto known = [&](const AppliedEffect& other) { return other.effect == use.effect; };
      if (std::none_of(effects_.begin(), effects_.end(), known)) {
        add(use);
      }
    }
  }

  /// Of the readings of all gauges from a unit source.
  [[nodiscard]] double model_s() const {
    return shortest([&](Scene& scene) {
      shape(effects_, scene);
      (void)transfers_of(scene, 0);
    });
  }

  /// Of one application of an expression, and of what it makes of a record.
  [[nodiscard]] double expression_s(const ExpressionEffect& effect) const {
    const std::vector<double> values = at_null(effect);
    return shortest([&](Scene& scene) {
      effect.apply(scene, values, 0);
      for (const auto& maps : scene.record.maps) {
        for (const RecordMap& map : maps) {
          std::vector<double> record(kPlaces, 1e-3);
          undo(map, record);
        }
      }
    });
  }

 private:
  void add(const EffectUse& use) {
    if (find_effect(use.effect->about().id) != use.effect) {
      return;
    }
    AppliedEffect applied{use.effect, 0, {}};
    for (const ModelValue& value : use.values) {
      applied.values.push_back(value.value);
    }
    effects_.push_back(std::move(applied));
  }

  static std::vector<double> at_null(const Effect& effect) {
    std::vector<double> values;
    for (const EffectParameter& own : effect.about().parameters) {
      values.push_back(own.auxiliary() ? own.starts.front() : own.null_value);
    }
    return values;
  }

  /// What else the computer does only ever adds to it: the shortest of several.
  template <typename Work>
  [[nodiscard]] double shortest(const Work& work) const {
    double best_s = std::numeric_limits<double>::infinity();
    for (int run = 0; run < 8; ++run) {
      Scene scene(bench_, facts_, path_);
      for (BarScene& bar : scene.bars) {
        bar.gamma_per_m.assign(kPlaces, Complex(1.0, 1.0));
      }
      const auto start = std::chrono::steady_clock::now();
      work(scene);
      best_s = std::min(
          best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best_s;
  }

  Bench bench_;
  ShotFacts facts_;
  std::vector<Complex> path_;
  std::vector<AppliedEffect> effects_;
};

/// Cosines beside a fit of the model without its expressions.
void tell_apart(const Settings& settings, const Model& model, const std::vector<Shot>& shots,
                std::vector<Checked>& list) {
  const Campaign campaign = read_campaign(shots);
  Study study(campaign, band_limit_of(settings.judged.band_limit_Hz), all_cores());
  Model without = model;
  std::erase_if(without.effects, [&](const EffectUse& use) {
    return std::any_of(model.expressions.begin(), model.expressions.end(),
                       [&](const auto& own) { return own.get() == use.effect; });
  });
  std::vector<std::string> ids;
  ids.reserve(list.size());
  for (const Checked& own : list) {
    ids.push_back(own.effect->about().id);
  }
  for (Distinction& own : distinctions(study, study.fit(without), ids)) {
    const std::string name = own.effect.substr(0, own.effect.find(':'));
    const auto found = std::find_if(list.begin(), list.end(), [&](const Checked& checked) {
      return checked.effect->about().id == name;
    });
    found->distinctions.push_back(std::move(own));
  }
}

/// Of captures an expression is checked beside their bench too, not only one of ordinary size.
void require_admitted_here(const Settings& settings, const Model& model, const Bench& bench) {
  for (const auto& own : model.expressions) {
    if (const auto problem = admission_problem(*own, model, bench)) {
      throw InputError(settings.model + ": expression " + own->about().id + " on this bench",
                       problem->check + ": " + problem->what, problem->mend);
    }
  }
}

JsonValue describe(const Checked& own) {
  JsonList distinctions;
  for (const Distinction& distinction : own.distinctions) {
    JsonList rivals;
    for (const Resemblance& rival : distinction.rivals) {
      rivals.push_back(JsonObject{{"effect", rival.effect}, {"cosine", rival.cosine}});
    }
    distinctions.push_back(JsonObject{{"effect", distinction.effect},
                                      {"parameter", distinction.parameter},
                                      {"unit", distinction.unit},
                                      {"absorbed_share", distinction.absorbed_share},
                                      {"smallest_detectable", distinction.detectable},
                                      {"smallest_identifiable", distinction.identifiable},
                                      {"rivals", std::move(rivals)}});
  }
  return JsonObject{{"id", own.effect->about().id},
                    {"stage", kolsky::name_of(own.effect->about().stage)},
                    {"formula", own.effect->text().formula},
                    {"admitted", true},
                    {"used", own.used},
                    {"time_s", own.time_s},
                    {"times_model", own.times_model},
                    {"slow", own.slow()},
                    {"here", std::move(distinctions)}};
}

/// From which size on, if from any that its bounds allow.
std::string seen_text(const Distinction& here) {
  if (!std::isfinite(here.detectable)) {
    return fmt::format("no {} within its bounds is seen here", here.parameter);
  }
  const std::string seen = fmt::format("{} from {:.2g}{} on is seen here, ", here.parameter,
                                       here.detectable, here.unit == "-" ? "" : " " + here.unit);
  return seen + (std::isfinite(here.identifiable)
                     ? fmt::format("from {:.2g} told apart", here.identifiable)
                     : "and none within its bounds told apart from what is nearest");
}

std::string text_of(const Checked& own) {
  const EffectAbout& about = own.effect->about();
  std::string text = fmt::format(
      "{} ({}): {}\n  admitted: nothing at null, derivative finite, "
      "passive, causal, units right{}\n"
      "  {:.0f} us along {} places: an evaluation takes {:.3g} times that of the model without "
      "it\n",
      about.id, kolsky::name_of(about.stage), about.definition,
      own.used ? "" : "; declared, not used: `kolsky diagnose` tries it", own.time_s * 1e6, kPlaces,
      own.times_model);
  if (own.slow()) {
    text += fmt::format(
        "  slow: more than {:g} times; fits and diagnoses take as much longer, shorten the "
        "formula\n",
        kSlow);
  }
  for (const Distinction& here : own.distinctions) {
    if (here.rivals.empty()) {
      text += fmt::format(
          "  {}: untestable on these captures, the model's own numbers take it up\n", here.effect);
      continue;
    }
    text += fmt::format("  {}: {}; {:.0f} % of it is taken up by the model\n      nearest:",
                        here.effect, seen_text(here), 100.0 * here.absorbed_share);
    for (std::size_t i = 0; i < std::min(kRivalsShown, here.rivals.size()); ++i) {
      text += fmt::format("{} {} (cosine {:.3f})", i == 0 ? "" : ",", here.rivals[i].effect,
                          here.rivals[i].cosine);
    }
    text += "\n";
  }
  return text;
}

int run(const Settings& settings, Context& context) {
  const ModelFile file = model_named(settings.model);
  std::vector<Checked> list;
  const Stopwatch stopwatch(file.model);
  const double model_s = file.model.expressions.empty() ? 1.0 : stopwatch.model_s();
  for (const auto& own : file.model.expressions) {
    const bool used = std::any_of(file.model.effects.begin(), file.model.effects.end(),
                                  [&](const EffectUse& use) { return use.effect == own.get(); });
    const double own_s = stopwatch.expression_s(*own);
    list.push_back({own.get(), used, own_s, 1.0 + own_s / model_s, {}});
  }
  if (!settings.judged.captures.empty()) {
    const std::vector<Shot> shots = read_shots(settings.judged);
    require_model_of(shots.front().bench, file.model, settings.model);
    if (!list.empty()) {
      require_admitted_here(settings, file.model, shots.front().bench);
      tell_apart(settings, file.model, shots, list);
    }
  }
  if (context.json) {
    JsonList expressions;
    for (const Checked& own : list) {
      expressions.push_back(describe(own));
    }
    context.out << to_text(JsonObject{{"model", settings.model},
                                      {"effects", describe_effects(file.model)},
                                      {"expressions", std::move(expressions)},
                                      {"edited_by_hand", file.edited_by_hand}})
                << "\n";
    return kDone;
  }
  context.out << settings.model << ": sound; " << counted(file.model.effects.size(), "effect")
              << ", " << counted(list.size(), "expression") << " of its own"
              << (file.edited_by_hand ? "; " + edited_text(file) : "") << "\n";
  for (const Checked& own : list) {
    context.out << "\n" << text_of(own);
  }
  return kDone;
}

}  // namespace

Command model_check_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "model check";
  command.purpose =
      "checks a model file and the effects that it declares by formula\n"
      "At null they must change nothing; no energy from nothing, no answer before the question, "
      "units\n"
      "right. With captures: what they could show of each, and which effects look like it there.\n"
      "An effect of your own, in the model file (docs/methods/expressions.md tells all stages):\n"
      "    [[expressions]]\n"
      "    id = \"my-branch\"\n"
      "    stage = \"material\"\n"
      "    formula = \"D / (1 + s*tau)\"\n"
      "    [expressions.parameters.D]\n"
      "    unit = \"1/Pa\"\n"
      "    null = 0.0\n"
      "    bounds = [0.0, 1e-9]\n"
      "    typical = 1e-12\n"
      "    [expressions.parameters.tau]\n"
      "    unit = \"s\"\n"
      "    starts = [1e-5, 1e-4, 1e-3]\n"
      "    bounds = [1e-6, 1e-1]\n"
      "    typical = 1e-5\n"
      "`kolsky model add M.toml my-branch` then uses it; `diagnose` tries it unasked.";
  command.examples =
      "  kolsky model check m.toml\n"
      "  kolsky model check m.toml shots/*.h5\n";
  command.arguments = {
      needed("MODEL", "", "the model file", &s.model),
      {"CAPTURE", "", "captures of one bench, or folders of them", &s.judged.captures, false, {}}};
  add_judged_options(s.judged, command.arguments);
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

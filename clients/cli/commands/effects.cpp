#include <fmt/format.h>

#include <map>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "processing/models/effect.hpp"

namespace kolsky::cli {
namespace {

std::vector<std::string> kinds_of(const EffectAbout& about) {
  std::vector<std::string> kinds;
  for (const BenchKind kind : about.kinds) {
    kinds.push_back(name_of(kind));
  }
  return kinds;
}

JsonValue describe(const EffectAbout& about) {
  JsonList parameters;
  for (const EffectParameter& parameter : about.parameters) {
    parameters.push_back(
        JsonObject{{"name", parameter.name},
                   {"unit", parameter.unit},
                   {"null", parameter.null_value},
                   {"null_value", parameter.null_value},
                   {"lower", parameter.lower},
                   {"upper", parameter.upper},
                   {"bounds", std::vector<double>{parameter.lower, parameter.upper}},
                   {"typical", parameter.typical},
                   {"auxiliary", parameter.auxiliary()}});
  }
  return JsonObject{{"id", about.id},
                    {"stage", kolsky::name_of(about.stage)},
                    {"definition", about.definition},
                    {"reference", about.reference},
                    {"kinds", kinds_of(about)},
                    {"per_gauge", about.per_gauge},
                    {"base", about.base},
                    {"parameters", std::move(parameters)}};
}

std::string list_of(const std::vector<double>& values) {
  std::string list;
  for (const double value : values) {
    list += (list.empty() ? "" : ", ") + fmt::format("{:g}", value);
  }
  return list;
}

/// "D [1/Pa], none at 0, from 0 to 1e-09"; what means nothing while the strength is null has no
/// value at which nothing is there.
std::string parameter_text(const EffectParameter& p) {
  const std::string name = p.unit == "-" ? p.name : fmt::format("{} [{}]", p.name, p.unit);
  if (p.chosen) {
    return fmt::format("    {}, one of {}\n", name, list_of(p.starts));
  }
  return fmt::format("    {}{}, from {:g} to {:g}\n", name,
                     p.auxiliary() ? "" : fmt::format(", none at {:g}", p.null_value), p.lower,
                     p.upper);
}

/// By stage, in the order in which they act.
std::string table() {
  std::map<Stage, std::string> stages;
  for (const Effect* effect : effect_library()) {
    const EffectAbout& about = effect->about();
    std::string& text = stages[about.stage];
    text += fmt::format("  {:<28} {}\n", about.id + (about.per_gauge ? ":GAUGE" : ""),
                        about.definition);
    for (const EffectParameter& p : about.parameters) {
      text += parameter_text(p);
    }
    text += "    models of kind " + joined(kinds_of(about)) +
            (about.reference.empty() ? "" : "; " + about.reference) + "\n";
  }
  std::string text;
  for (const auto& [stage, own] : stages) {
    text += (text.empty() ? "" : "\n") + kolsky::name_of(stage) + "\n" + own;
  }
  return text;
}

int run(Context& context) {
  if (!context.json) {
    context.out << table();
    return kDone;
  }
  JsonList list;
  for (const Effect* effect : effect_library()) {
    list.push_back(describe(effect->about()));
  }
  context.out << to_text(JsonObject{{"effects", std::move(list)}}) << "\n";
  return kDone;
}

}  // namespace

Command effects_command() {
  Command command;
  command.name = "effects";
  command.purpose =
      "the library of effects that a model may hold\n"
      "Each with the stage it acts at, its parameters with unit, bounds and the value at which it\n"
      "is not there, the kinds of models that may hold it, and its reference.";
  command.examples = "  kolsky effects\n  kolsky effects --json\n";
  command.run = [](Context& context) { return run(context); };
  return command;
}

}  // namespace kolsky::cli

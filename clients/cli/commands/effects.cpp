#include <fmt/format.h>

#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "processing/models/effect.hpp"

namespace kolsky::cli {
namespace {

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
  std::vector<std::string> kinds;
  for (const BenchKind kind : about.kinds) {
    kinds.push_back(name_of(kind));
  }
  return JsonObject{{"id", about.id},
                    {"stage", kolsky::name_of(about.stage)},
                    {"definition", about.definition},
                    {"reference", about.reference},
                    {"kinds", kinds},
                    {"per_gauge", about.per_gauge},
                    {"base", about.base},
                    {"parameters", std::move(parameters)}};
}

std::string table() {
  std::string text;
  for (const Effect* effect : effect_library()) {
    const EffectAbout& about = effect->about();
    text += fmt::format("{:<28} {:<12} {}\n", about.id + (about.per_gauge ? ":GAUGE" : ""),
                        kolsky::name_of(about.stage), about.definition);
    for (const EffectParameter& p : about.parameters) {
      text += fmt::format("    {} [{}], none at {:g}, from {:g} to {:g}\n", p.name, p.unit,
                          p.null_value, p.lower, p.upper);
    }
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
      "is not there, and its reference.";
  command.examples = "  kolsky effects\n  kolsky effects --json\n";
  command.run = [](Context& context) { return run(context); };
  return command;
}

}  // namespace kolsky::cli

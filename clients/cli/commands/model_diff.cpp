#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "drivers/files/models/model_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

struct Settings {
  std::string before;
  std::string after;
};

/// A number that differs between two models.
struct Change {
  std::string effect;
  std::string parameter;
  std::string unit;
  ModelValue before;
  ModelValue after;

  /// The difference over its deviation, as if the two were independent; 0 where none is known.
  [[nodiscard]] double deviations() const {
    const double sd = std::hypot(before.sd, after.sd);
    return sd > 0.0 ? (after.value - before.value) / sd : 0.0;
  }
};

struct Difference {
  std::vector<std::string> added;
  std::vector<std::string> removed;
  std::vector<Change> changes;
};

bool differ(const ModelValue& a, const ModelValue& b) {
  return a.value != b.value || a.free != b.free || a.prior_sd != b.prior_sd;
}

Difference difference_of(const Model& before, const Model& after) {
  Difference difference;
  for (const EffectUse& use : after.effects) {
    const EffectUse* old = before.find(use.id());
    if (old == nullptr) {
      difference.added.push_back(use.id());
      continue;
    }
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      if (differ(old->values[p], use.values[p])) {
        const EffectParameter& parameter = use.effect->about().parameters[p];
        difference.changes.push_back(
            {use.id(), parameter.name, parameter.unit, old->values[p], use.values[p]});
      }
    }
  }
  for (const EffectUse& use : before.effects) {
    if (after.find(use.id()) == nullptr) {
      difference.removed.push_back(use.id());
    }
  }
  return difference;
}

JsonValue describe(const Difference& difference) {
  JsonList changes;
  for (const Change& change : difference.changes) {
    const auto side = [](const ModelValue& value) {
      return JsonObject{{"value", value.value},
                        {"sd", value.sd},
                        {"free", value.free},
                        {"prior_sd", value.prior_sd}};
    };
    changes.push_back(JsonObject{{"effect", change.effect},
                                 {"parameter", change.parameter},
                                 {"unit", change.unit},
                                 {"before", side(change.before)},
                                 {"after", side(change.after)},
                                 {"deviations", change.deviations()}});
  }
  return JsonObject{{"added", difference.added},
                    {"removed", difference.removed},
                    {"changes", std::move(changes)}};
}

std::string how_held(const ModelValue& value) {
  if (value.prior_sd > 0.0) {
    return "within its prior";
  }
  return value.free ? "free" : "held";
}

std::string text_of(const Difference& difference) {
  std::string text;
  for (const std::string& id : difference.removed) {
    text += "- " + id + "\n";
  }
  for (const std::string& id : difference.added) {
    text += "+ " + id + "\n";
  }
  for (const Change& change : difference.changes) {
    text += fmt::format("  {}.{}: {:.6g} ± {:.2g} -> {:.6g} ± {:.2g} {}", change.effect,
                        change.parameter, change.before.value, change.before.sd, change.after.value,
                        change.after.sd, change.unit);
    if (change.deviations() != 0.0) {
      text += fmt::format("  ({:+.1f} deviations)", change.deviations());
    }
    const std::string was = how_held(change.before);
    const std::string is = how_held(change.after);
    text += was == is ? "\n" : fmt::format(", {} -> {}\n", was, is);
  }
  return text.empty() ? "the two models are the same\n" : text;
}

/// "m.toml", or "m.toml@3": as it was after three steps; @0 is how it began.
Model model_at(const std::string& name) {
  const auto at = name.rfind('@');
  if (at == std::string::npos) {
    return read_model(name).model;
  }
  const std::string path = name.substr(0, at);
  const std::string step = name.substr(at + 1);
  const ModelFile file = read_model(path);
  if (step.empty() || step.size() > 6 ||
      step.find_first_not_of("0123456789") != std::string::npos ||
      std::stoul(step) > file.history.size()) {
    throw InputError(name, fmt::format("names no step: {} has {}", path, file.history.size()),
                     fmt::format("give a number from 0 to {}; `kolsky model history {}` lists them",
                                 file.history.size(), path));
  }
  const std::size_t index = std::stoul(step);
  return index == file.history.size()
             ? file.model
             : parse_model(file.history[index].before, path + ": history").model;
}

int run(const Settings& settings, Context& context) {
  const Model before = model_at(settings.before);
  const Model after = model_at(settings.after);
  if (before.kind != after.kind) {
    throw InputError(settings.after, "is of another kind of bench than " + settings.before,
                     "compare models of one kind");
  }
  const Difference difference = difference_of(before, after);
  context.out << (context.json ? to_text(describe(difference)) + "\n" : text_of(difference));
  return kDone;
}

}  // namespace

Command model_diff_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "model diff";
  command.purpose =
      "what differs between two models: effects, and every number that moved\n"
      "M.toml@N is a model as it was after N steps of its history, M.toml@0 as it began.";
  command.examples =
      "  kolsky model diff m1.toml m2.toml\n"
      "  kolsky model diff m2.toml@0 m2.toml\n";
  command.arguments = {needed("BEFORE", "", "a model file, or M.toml@N", &s.before),
                       needed("AFTER", "", "a model file, or M.toml@N", &s.after)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

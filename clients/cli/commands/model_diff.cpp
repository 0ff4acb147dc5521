#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/reports/model_text.hpp"
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

  /// The difference over its deviation, as if the two were independent; 0 where one of them is a
  /// start or a choice, which has none.
  [[nodiscard]] double deviations() const {
    const bool known = before.sd > 0.0 && after.sd > 0.0;
    return known ? (after.value - before.value) / std::hypot(before.sd, after.sd) : 0.0;
  }
};

struct Difference {
  std::vector<std::string> added;
  std::vector<std::string> removed;
  std::vector<Change> changes;
  std::vector<Declared> expressions;
  bool otherwise = false;  ///< in what none of these tells: bounds, priors, shots of their own
};

bool differ(const ModelValue& a, const ModelValue& b) {
  return a.value != b.value || a.free != b.free || a.prior_sd != b.prior_sd;
}

std::string text_of(const Model& model) {
  ModelFile file;
  file.model = model;
  return format_model(file);
}

Difference difference_of(const Model& before, const Model& after) {
  Difference difference;
  difference.expressions = declared_anew(before, after);
  difference.otherwise = text_of(before) != text_of(after);
  for (const EffectUse& use : after.effects) {
    const EffectUse* old = before.find(use.id());
    if (old == nullptr) {
      difference.added.push_back(use.id());
      continue;
    }
    for (std::size_t p = 0; p < std::min(use.values.size(), old->values.size()); ++p) {
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
  JsonList expressions;
  for (const Declared& own : difference.expressions) {
    const auto formula = [](const std::string& text) {
      return text.empty() ? JsonValue(nullptr) : JsonValue(text);
    };
    expressions.push_back(
        JsonObject{{"id", own.id}, {"before", formula(own.before)}, {"after", formula(own.after)}});
  }
  return JsonObject{{"added", difference.added},
                    {"removed", difference.removed},
                    {"changes", std::move(changes)},
                    {"expressions", std::move(expressions)},
                    {"same", !difference.otherwise}};
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
  for (const Declared& own : difference.expressions) {
    text += own.text() + "\n";
  }
  for (const Change& change : difference.changes) {
    constexpr double kShown = 0.05;
    text += fmt::format("  {}.{}: {} -> {}", change.effect, change.parameter,
                        number_text(change.before.value, change.before.sd, change.unit),
                        number_text(change.after.value, change.after.sd, change.unit));
    if (std::abs(change.deviations()) >= kShown) {
      text += fmt::format("  ({:+.1f} deviations)", change.deviations());
    }
    const std::string was = how_held(change.before);
    const std::string is = how_held(change.after);
    text += was == is ? "\n" : fmt::format(", {} -> {}\n", was, is);
  }
  if (text.empty() && difference.otherwise) {
    return "the two models differ in deviations, bounds, priors, order or which shots share a "
           "number\n";
  }
  return text.empty() ? "the two models are the same\n" : text;
}

int run(const Settings& settings, Context& context) {
  const Model before = model_named(settings.before).model;
  const Model after = model_named(settings.after).model;
  if (before.kind != after.kind) {
    throw InputError(settings.after,
                     fmt::format("is a model of a bench of kind {}, and {} of one of kind {}",
                                 name_of(after.kind), settings.before, name_of(before.kind)),
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
      "what differs between two models: effects, formulas, and every number that moved\n"
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

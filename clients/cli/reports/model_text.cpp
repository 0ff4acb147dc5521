#include "clients/cli/reports/model_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "clients/cli/reports/diagnosis_text.hpp"
#include "clients/figure/layout.hpp"
#include "drivers/files/models/model_expressions.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/fitting/composition.hpp"
#include "processing/criticism/verdict/at_bounds.hpp"

namespace kolsky::cli {

namespace {

std::string name_of_parameter(const Model& model, const EffectUse& use,
                              const EffectParameter& parameter) {
  const std::string& id = use.effect->about().id;
  if (id == "three-element-specimen") {
    return parameter.name;
  }
  if (id == "three-element-bar") {
    return model.kind == BenchKind::bar ? parameter.name : "bar." + parameter.name;
  }
  return use.id() + "." + parameter.name;
}

struct Strained {
  std::string name;
  double deviations;
};

std::vector<Strained> strained_numbers(const Model& model) {
  constexpr double kMost = 3.0;
  std::vector<Strained> list;
  for (const EffectUse& use : model.effects) {
    for (std::size_t p = 0; p < use.values.size(); ++p) {
      const ModelValue& value = use.values[p];
      const double off =
          value.prior_sd > 0.0 ? (value.value - value.prior_mean) / value.prior_sd : 0.0;
      if (std::abs(off) > kMost) {
        list.push_back({name_of_parameter(model, use, use.effect->about().parameters[p]), off});
      }
    }
  }
  return list;
}

/// Where a fit may take a number: the model file's bounds, else the effect's own.
std::array<double, 2> bounds_of(const ModelValue& value, const EffectParameter& parameter) {
  return value.bounds.value_or(std::array{parameter.lower, parameter.upper});
}

/// Whether a fit found nothing of the effect: then its times and places may be anything.
bool is_none(const EffectUse& use) {
  const std::vector<EffectParameter>& parameters = use.effect->about().parameters;
  bool none = !has_own_strengths(use);
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ModelValue& value = use.values[p];
    const bool near =
        value.sd > 0.0 && std::abs(value.value - parameters[p].null_value) <= value.sd;
    none = none && (parameters[p].auxiliary() || near);
  }
  return none;
}

}  // namespace

JsonValue describe_effects(const Model& model) {
  JsonList list;
  for (const EffectUse& use : model.effects) {
    const EffectAbout& about = use.effect->about();
    JsonObject parameters;
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      const ModelValue& value = use.values[p];
      const auto [least, most] = bounds_of(value, about.parameters[p]);
      parameters.push_back(
          {about.parameters[p].name, JsonObject{{"value", value.value},
                                                {"sd", value.sd},
                                                {"unit", about.parameters[p].unit},
                                                {"free", value.free},
                                                {"null", about.parameters[p].null_value},
                                                {"bounds", JsonList{least, most}}}});
    }
    list.push_back(
        JsonObject{{"id", use.id()},
                   {"stage", kolsky::name_of(about.stage)},
                   {"per_shot", use.per_shot},
                   {"alike", use.alike},
                   {"known_unknown", !use.values.empty() && use.values[0].prior_sd > 0.0},
                   {"parameters", std::move(parameters)}});
  }
  return list;
}

JsonValue describe_parameters(const Model& model) {
  JsonObject object;
  for (const EffectUse& use : model.effects) {
    const EffectAbout& about = use.effect->about();
    for (std::size_t p = 0; p < about.parameters.size(); ++p) {
      const ModelValue& value = use.values[p];
      object.push_back({name_of_parameter(model, use, about.parameters[p]),
                        JsonObject{{"value", value.value},
                                   {"sd", value.sd},
                                   {"unit", about.parameters[p].unit},
                                   {"free", value.free}}});
    }
  }
  return object;
}

std::string number_text(double value, double sd, const std::string& unit) {
  if (unit == "Pa s") {
    return number_text(value, sd, "Pa") + " s";
  }
  // What takes no prefix is written with a power of ten, or a small one would lose its digits.
  const bool plain = display_unit(unit, 1e-9).factor == 1.0;
  if (sd > 0.0) {
    return plain ? strength_text(value, sd, unit) : with_deviation(value, sd, unit);
  }
  return with_unit(value, unit);
}

std::string effect_text(const EffectUse& use) {
  const EffectAbout& about = use.effect->about();
  std::string text =
      fmt::format("  {:<28} {:<12} {}\n", use.id(), kolsky::name_of(about.stage), about.definition);
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const ModelValue& value = use.values[p];
    const std::string& unit = about.parameters[p].unit;
    std::string held = value.prior_sd > 0.0
                           ? "  filed within " + number_text(value.prior_sd, 0.0, unit)
                           : (value.free ? "" : "  held");
    if (value.bounds) {
      held += "  between " + number_text(value.bounds->front(), 0.0, unit) + " and " +
              number_text(value.bounds->back(), 0.0, unit);
    }
    const bool open = value.free && about.parameters[p].auxiliary() && is_none(use);
    text += fmt::format(
        "      {} = {}{}\n", about.parameters[p].name,
        open ? "open, as nothing of the effect shows" : number_text(value.value, value.sd, unit),
        held);
  }
  return text;
}

std::string model_table(const Model& model) {
  std::string text;
  for (const EffectUse& use : model.effects) {
    text += effect_text(use);
  }
  return text;
}

std::string Declared::text() const {
  if (before.empty() || after.empty()) {
    return fmt::format("{} expression {}: {}", before.empty() ? '+' : '-', id, before + after);
  }
  return before == after
             ? fmt::format("  expression {}: declared otherwise, its formula as before", id)
             : fmt::format("  expression {}: {} -> {}", id, before, after);
}

std::vector<Declared> declared_anew(const Model& before, const Model& after) {
  const auto declared = [](const Model& model, const std::string& id) -> const ExpressionText* {
    const auto own = std::ranges::find_if(
        model.expressions, [&](const auto& expression) { return expression->text().id == id; });
    return own == model.expressions.end() ? nullptr : &(*own)->text();
  };
  std::vector<Declared> list;
  for (const auto& own : before.expressions) {
    const ExpressionText& old = own->text();
    const ExpressionText* now = declared(after, old.id);
    if (now == nullptr) {
      list.push_back({old.id, old.formula, ""});
    } else if (format_expression(old) != format_expression(*now)) {
      list.push_back({old.id, old.formula, now->formula});
    }
  }
  for (const auto& own : after.expressions) {
    if (declared(before, own->text().id) == nullptr) {
      list.push_back({own->text().id, "", own->text().formula});
    }
  }
  return list;
}

bool is_strained(const Model& model) {
  return !strained_numbers(model).empty();
}

JsonValue describe_strained(const Model& model) {
  JsonList list;
  for (const Strained& number : strained_numbers(model)) {
    list.push_back(JsonObject{{"name", number.name}, {"deviations", number.deviations}});
  }
  return list;
}

std::string strained_list(const Model& model) {
  std::string text;
  for (const Strained& number : strained_numbers(model)) {
    text += fmt::format("{}{} {:+.1f}", text.empty() ? "" : ", ", number.name, number.deviations);
  }
  return text;
}

std::string strained_text(const Model& model) {
  const std::string list = strained_list(model);
  return list.empty() ? ""
                      : "strained, in filed deviations: " + list +
                            "\nthey are not as filed, or stand in for what the model lacks; "
                            "`kolsky diagnose` tells which\n";
}

JsonValue describe_bounds(const Model& model) {
  JsonList list;
  for (const AtBound& number : numbers_at_bounds(model)) {
    list.push_back(JsonObject{{"effect", number.effect},
                              {"parameter", number.parameter},
                              {"bound", number.most ? "most" : "least"}});
  }
  return list;
}

std::string bounds_text(const Model& model) {
  std::string text;
  for (const AtBound& number : numbers_at_bounds(model)) {
    text += "note: " + in_words(number) + "\n";
  }
  return text;
}

BenchKind bench_kind(const std::string& name) {
  if (name == "bar") {
    return BenchKind::bar;
  }
  return name == "shpb" ? BenchKind::shpb : BenchKind::impact;
}

std::string counted(std::size_t count, const std::string& of) {
  return std::to_string(count) + " " + of + (count == 1 ? "" : "s");
}

}  // namespace kolsky::cli

#include "drivers/files/models/model_expressions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/files/models/toml_values.hpp"
#include "processing/models/admission.hpp"

namespace kolsky {

namespace {

constexpr std::array kStages{Stage::material, Stage::specimen, Stage::propagation,
                             Stage::boundary, Stage::sensor,   Stage::record};
constexpr double kLargestNumber = 1e30;
constexpr std::size_t kMostStarts = 16;
constexpr std::size_t kMostParameters = 8;

bool names(const std::string& text, bool dashes) {
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto upper = [](char c) { return c >= 'A' && c <= 'Z'; };
  const auto other = [&](char c) { return (c >= '0' && c <= '9') || c == (dashes ? '-' : '_'); };
  return !text.empty() && (lower(text.front()) || (!dashes && upper(text.front()))) &&
         std::all_of(text.begin(), text.end(),
                     [&](char c) { return lower(c) || other(c) || (!dashes && upper(c)); });
}

double within(const TomlTable& table, const std::string& key, double value,
              const EffectParameter& parameter) {
  if (value < parameter.lower || value > parameter.upper) {
    throw table.error(
        key, fmt::format("holds {:g}, out of its bounds", value),
        fmt::format("give numbers from {:g} to {:g}", parameter.lower, parameter.upper));
  }
  return value;
}

EffectParameter read_parameter(const TomlTable& table, const std::string& name) {
  table.expect({"unit", "bounds", "null", "typical", "starts"});
  EffectParameter parameter;
  parameter.name = name;
  parameter.unit = table.text("unit");
  const std::vector<double> bounds = table.numbers("bounds");
  if (bounds.size() != 2 || !(bounds[0] < bounds[1]) ||
      std::max(std::abs(bounds[0]), std::abs(bounds[1])) > kLargestNumber) {
    throw table.error("bounds", "are not two numbers, the lower first",
                      "give [lower, upper] in " + parameter.unit);
  }
  parameter.lower = bounds[0];
  parameter.upper = bounds[1];
  parameter.typical = table.number("typical");
  if (parameter.typical <= 0.0 || parameter.typical > bounds[1] - bounds[0]) {
    throw table.error("typical", "is not a size above 0 that fits between the bounds",
                      "give how much of it matters");
  }
  if (table.has("starts") == table.has("null")) {
    throw table.error(
        "", "has " + std::string(table.has("null") ? "both" : "neither of") + " null and starts",
        "give null to a strength, starts to a parameter that means nothing without "
        "one");
  }
  if (table.has("null")) {
    parameter.null_value = within(table, "null", table.number("null"), parameter);
    return parameter;
  }
  parameter.starts = table.numbers("starts");
  if (parameter.starts.empty() || parameter.starts.size() > kMostStarts) {
    throw table.error("starts", fmt::format("holds {} values", parameter.starts.size()),
                      fmt::format("give 1 to {} from which searches start", kMostStarts));
  }
  for (const double start : parameter.starts) {
    (void)within(table, "starts", start, parameter);
  }
  return parameter;
}

std::vector<EffectParameter> read_parameters(const TomlTable& table) {
  const TomlTable own = table.table("parameters");
  std::vector<EffectParameter> list;
  for (const std::string& name : own.keys()) {
    if (!names(name, false)) {
      throw table.error("parameters", "has a name that no formula can hold: \"" + name + "\"",
                        "use letters, digits and _");
    }
    list.push_back(read_parameter(own.table(name), name));
  }
  if (list.size() > kMostParameters) {
    throw table.error("parameters", fmt::format("are {}", list.size()),
                      fmt::format("use at most {}", kMostParameters));
  }
  return list;
}

/// "formula: column 3" and "parameters.D.unit" as places of the file.
InputError located(const TomlTable& table, const InputError& error) {
  const std::string& place = error.place();
  const auto colon = place.find(": ");
  const std::string key = place.substr(0, colon);
  const std::string inside = colon == std::string::npos ? "" : place.substr(colon + 2) + ": ";
  if (key.starts_with("parameters.")) {
    const auto dot = key.find('.', key.find('.') + 1);
    const std::string name = key.substr(11, dot == std::string::npos ? dot : dot - 11);
    return table.table("parameters")
        .table(name)
        .error(dot == std::string::npos ? "" : key.substr(dot + 1), inside + error.problem(),
               error.mend());
  }
  return table.error(key, inside + error.problem(), error.mend());
}

}  // namespace

std::shared_ptr<const ExpressionEffect> read_expression(const TomlTable& table,
                                                        const Model& model) {
  table.expect({"id", "stage", "formula", "note", "per_gauge", "per_shot", "parameters"});
  ExpressionText text;
  text.id = table.text("id");
  if (!names(text.id, true)) {
    throw table.error("id", "\"" + text.id + "\" is no name for an effect",
                      "use lower-case letters, digits and -, as my-branch");
  }
  for (const Effect* known : effects_known_to(model)) {
    if (known->about().id == text.id) {
      throw table.error("id", "\"" + text.id + "\" is an effect already", "choose another name");
    }
  }
  text.stage = kStages.at(table.choice(
      "stage", {"material", "specimen", "propagation", "boundary", "sensor", "record"}));
  text.formula = table.text("formula");
  text.note = table.optional_text("note").value_or("");
  text.per_gauge = table.optional_flag("per_gauge").value_or(false);
  if (text.per_gauge && text.stage != Stage::sensor && text.stage != Stage::record) {
    throw table.error("per_gauge", "is true, and the stage is not a gauge's", "remove it");
  }
  text.per_shot = table.optional_flag("per_shot").value_or(false);
  text.parameters = read_parameters(table);
  std::shared_ptr<const ExpressionEffect> effect;
  try {
    effect = std::make_shared<const ExpressionEffect>(std::move(text));
  } catch (const InputError& error) {
    throw located(table, error);
  }
  if (model.kind == BenchKind::impact) {
    throw table.error("formula",
                      "acts on bars, and a ball's force is calculated by finite elements, which "
                      "take no formula",
                      "remove it; `kolsky effects` lists what a ball can have");
  }
  const auto& kinds = effect->about().kinds;
  if (std::find(kinds.begin(), kinds.end(), model.kind) == kinds.end()) {
    throw table.error("stage", "does not belong to this kind of bench", "choose another stage");
  }
  return effect;
}

void require_admissible(const TomlTable& table, const ExpressionEffect& effect,
                        const Model& model) {
  if (const auto problem = admission_problem(effect, model, admission_bench(model.kind))) {
    throw table.error("formula", problem->check + ": " + problem->what, problem->mend);
  }
}

std::string format_expression(const ExpressionText& text) {
  std::string out = "\n[[expressions]]\nid = " + toml_quoted(text.id) + "\nstage = \"" +
                    name_of(text.stage) + "\"\nformula = " + toml_quoted(text.formula) + "\n";
  if (!text.note.empty()) {
    out += "note = " + toml_quoted(text.note) + "\n";
  }
  if (text.per_gauge) {
    out += "per_gauge = true\n";
  }
  if (text.per_shot) {
    out += "per_shot = true\n";
  }
  for (const EffectParameter& own : text.parameters) {
    out += "[expressions.parameters." + own.name + "]\nunit = " + toml_quoted(own.unit) +
           "\nbounds = [" + toml_number(own.lower) + ", " + toml_number(own.upper) +
           "]\ntypical = " + toml_number(own.typical) + "\n";
    if (own.auxiliary()) {
      std::string starts;
      for (const double start : own.starts) {
        starts += (starts.empty() ? "" : ", ") + toml_number(start);
      }
      out += "starts = [" + starts + "]\n";
    } else {
      out += "null = " + toml_number(own.null_value) + "\n";
    }
  }
  return out;
}

}  // namespace kolsky

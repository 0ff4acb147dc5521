#include "drivers/files/model_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "drivers/files/sha256.hpp"
#include "drivers/files/toml_table.hpp"
#include "drivers/files/toml_text.hpp"

namespace kolsky {

namespace {

constexpr std::int64_t kFormat = 1;

ModelValue read_value(const TomlTable& table, const EffectParameter& parameter) {
  table.expect({"value", "sd", "unit", "free", "prior_sd", "prior_mean"});
  ModelValue value;
  value.value = table.number("value");
  value.sd = table.optional_number("sd").value_or(0.0);
  value.prior_sd = table.optional_number("prior_sd").value_or(0.0);
  value.prior_mean = table.optional_number("prior_mean").value_or(value.value);
  value.free = table.optional_flag("free").value_or(true);
  if (const auto unit = table.optional_text("unit"); unit && *unit != parameter.unit) {
    throw table.error("unit",
                      "is \"" + *unit + "\" and " + parameter.name + " is in " + parameter.unit,
                      "give the value in " + parameter.unit);
  }
  if (value.value < parameter.lower || value.value > parameter.upper) {
    throw table.error("value",
                      fmt::format("{} is out of bounds for {}", value.value, parameter.name),
                      fmt::format("give a number from {} to {} {}", parameter.lower,
                                  parameter.upper, parameter.unit));
  }
  if (value.sd < 0.0 || value.prior_sd < 0.0) {
    throw table.error(value.sd < 0.0 ? "sd" : "prior_sd", "is negative",
                      "give a standard deviation of 0 or more");
  }
  return value;
}

EffectUse read_use(const TomlTable& table) {
  table.expect({"id", "per_shot", "alike", "parameters"});
  EffectUse use;
  try {
    use = use_named(table.text("id"));
  } catch (const InputError& error) {
    throw table.error("id", "\"" + table.text("id") + "\": " + error.problem(), error.mend());
  }
  use.alike = table.optional_flag("alike").value_or(false);
  if (use.alike && !use.effect->about().each_gauge) {
    throw table.error("alike", "is true, and " + use.id() + " has no strengths by gauge",
                      "leave it out");
  }
  use.per_shot = table.optional_flag("per_shot").value_or(false);
  if (use.per_shot && !use.effect->about().per_shot) {
    throw table.error("per_shot", "is true, and " + use.id() + " is one for all shots",
                      "remove it");
  }
  if (const auto parameters = table.optional_table("parameters")) {
    const auto& known = use.effect->about().parameters;
    for (std::size_t p = 0; p < known.size(); ++p) {
      if (const auto own = parameters->optional_table(known[p].name)) {
        use.values[p] = read_value(*own, known[p]);
      }
    }
  }
  return use;
}

ModelFile read(const TomlTable& table) {
  table.expect({"kolsky_model", "kind", "bar_source", "effects", "history"});
  if (table.integer("kolsky_model") != kFormat) {
    throw table.error("kolsky_model", "is a format that this version does not know",
                      "make the model anew with `kolsky model new`");
  }
  ModelFile file;
  constexpr std::array kKinds{BenchKind::bar, BenchKind::shpb, BenchKind::impact};
  file.model.kind = kKinds.at(table.choice("kind", {"bar", "shpb", "impact"}));
  file.bar_source = table.optional_text("bar_source").value_or("");
  for (const TomlTable& own : table.tables("effects")) {
    EffectUse use = read_use(own);
    const auto& kinds = use.effect->about().kinds;
    if (std::find(kinds.begin(), kinds.end(), file.model.kind) == kinds.end()) {
      throw own.error("id", "\"" + use.id() + "\" does not belong to this kind of bench",
                      "remove it");
    }
    if (file.model.find(use.id()) != nullptr) {
      throw own.error("id", "\"" + use.id() + "\" is there twice", "keep one");
    }
    file.model.effects.push_back(std::move(use));
  }
  for (const TomlTable& own : table.tables("history")) {
    file.history.push_back(read_step(own));
  }
  table.finish();
  return file;
}

std::string format_use(const EffectUse& use) {
  std::string text = "\n[[effects]]\nid = " + toml_quoted(use.id()) + "\n";
  if (use.alike) {
    text += "alike = true\n";
  }
  if (use.per_shot) {
    text += "per_shot = true\n";
  }
  const auto& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ModelValue& value = use.values[p];
    text += "[effects.parameters." + parameters[p].name + "]\n";
    text += "value = " + toml_number(value.value) + "\n";
    if (value.sd > 0.0) {
      text += "sd = " + toml_number(value.sd) + "\n";
    }
    if (value.prior_sd > 0.0) {
      text += "prior_mean = " + toml_number(value.prior_mean) +
              "\nprior_sd = " + toml_number(value.prior_sd) + "\n";
    }
    text += "unit = " + toml_quoted(parameters[p].unit) + "\n";
    text += std::string("free = ") + (value.free ? "true" : "false") + "\n";
  }
  return text;
}

}  // namespace

ModelFile read_model(const std::filesystem::path& path) {
  return read(TomlTable::open(path));
}

ModelFile parse_model(const std::string& text, const std::string& name) {
  return read(TomlTable::parse(text, name));
}

std::string format_model(const ModelFile& file, bool with_history) {
  const std::array<const char*, 3> kinds{"bar", "shpb", "impact"};
  std::string text = fmt::format("kolsky_model = {}\nkind = \"{}\"\n", kFormat,
                                 kinds.at(static_cast<std::size_t>(file.model.kind)));
  if (!file.bar_source.empty()) {
    text += "bar_source = " + toml_quoted(file.bar_source) + "\n";
  }
  for (const EffectUse& use : file.model.effects) {
    text += format_use(use);
  }
  if (with_history) {
    for (const ModelStep& step : file.history) {
      text += format_step(step);
    }
  }
  return text;
}

void begin_step(ModelFile& file, const std::string& action, const std::string& when) {
  ModelStep step;
  step.action = action;
  step.when = when;
  step.software = KOLSKY_VERSION;
  step.before = format_model(file, false);
  step.parent = sha256_hex(std::as_bytes(std::span(step.before)));
  file.history.push_back(std::move(step));
}

}  // namespace kolsky

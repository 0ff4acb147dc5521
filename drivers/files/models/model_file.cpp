#include "drivers/files/models/model_file.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <optional>
#include <span>
#include <utility>

#include "drivers/files/models/model_expressions.hpp"
#include "drivers/files/models/toml_values.hpp"
#include "drivers/files/settings/file_bytes.hpp"
#include "drivers/files/settings/toml_table.hpp"
#include "drivers/files/sha256.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::int64_t kFormat = 1;
constexpr std::size_t kMostCaptureBytes = std::size_t{1} << 32U;

std::optional<std::array<double, 2>> read_bounds(const TomlTable& table,
                                                 const EffectParameter& parameter) {
  if (!table.has("bounds")) {
    return std::nullopt;
  }
  const std::vector<double> bounds = table.numbers("bounds");
  if (bounds.size() != 2 || !(bounds[0] < bounds[1]) || bounds[0] < parameter.lower ||
      bounds[1] > parameter.upper) {
    throw table.error(
        "bounds", "are not two numbers in rising order that " + parameter.name + " can be between",
        fmt::format("give them within {} to {} {}", parameter.lower, parameter.upper,
                    parameter.unit));
  }
  return std::array{bounds[0], bounds[1]};
}

ModelValue read_value(const TomlTable& table, const EffectParameter& parameter) {
  table.expect({"value", "sd", "unit", "free", "prior_sd", "prior_mean", "bounds"});
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
  value.bounds = read_bounds(table, parameter);
  const auto [least, most] = value.bounds.value_or(std::array{parameter.lower, parameter.upper});
  if (value.value < least || value.value > most) {
    throw table.error("value",
                      fmt::format("{} is out of bounds for {}", value.value, parameter.name),
                      fmt::format("give a number from {} to {} {}", least, most, parameter.unit));
  }
  if (value.sd < 0.0) {
    throw table.error("sd", "is negative", "give a standard deviation of 0 or more");
  }
  if (table.has("prior_sd") && !(value.prior_sd > 0.0)) {
    throw table.error("prior_sd", "is not a standard deviation",
                      "give more than 0, or `free = false` for a number that is known");
  }
  return value;
}

/// Positive definite, symmetric, ones on the diagonal: what a prior needs.
void require_correlation(const TomlTable& table, const std::vector<double>& own,
                         const EffectUse& use) {
  const std::size_t count = use.values.size();
  bool sound = own.size() == count * count;
  for (std::size_t a = 0; sound && a < count; ++a) {
    sound = std::abs(own[a * count + a] - 1.0) < 1e-9;
    for (std::size_t b = 0; sound && b < a; ++b) {
      sound = std::abs(own[a * count + b] - own[b * count + a]) < 1e-9;
    }
  }
  // Cholesky's factor exists for nothing else.
  std::vector<double> factor = own;
  for (std::size_t a = 0; sound && a < count; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      double sum = factor[a * count + b];
      for (std::size_t k = 0; k < b; ++k) {
        sum -= factor[a * count + k] * factor[b * count + k];
      }
      if (a == b) {
        sound = sound && sum > 0.0;
        factor[a * count + a] = std::sqrt(std::max(sum, 0.0));
      } else {
        factor[a * count + b] = factor[b * count + b] > 0.0 ? sum / factor[b * count + b] : 0.0;
      }
    }
  }
  if (!sound) {
    throw table.error(
        "prior_correlation", "is not a correlation of this effect's parameters",
        fmt::format("give {} x {} numbers, symmetric and positive definite", count, count));
  }
}

/// No fit has found any of its numbers yet, and one is to.
bool awaits_a_fit(const EffectUse& use) {
  return std::ranges::any_of(use.values, &ModelValue::free) &&
         std::ranges::all_of(use.values, [](const ModelValue& value) { return value.sd == 0.0; });
}

EffectUse read_use(const TomlTable& table, const Model& model) {
  table.expect({"id", "per_shot", "alike", "parameters", "prior_correlation"});
  EffectUse use;
  try {
    use = use_named(table.text("id"), model);
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
  use.form_open = use.effect->about().per_shot && !table.has("per_shot") && awaits_a_fit(use);
  if (table.has("prior_correlation")) {
    use.prior_correlation = table.numbers("prior_correlation");
    require_correlation(table, use.prior_correlation, use);
  }
  return use;
}

void require_a_model(const TomlTable& table);

/// Without its seal any history would pass.
void require_sealed(const TomlTable& table, const std::vector<ModelStep>& history) {
  const auto seal = table.optional_text("ledger");
  if (!seal && history.empty()) {
    return;
  }
  if (!seal) {
    throw table.error("ledger", "is not there: nothing tells whether the history is as it was",
                      "take the file from a copy that has that line, or begin anew without any "
                      "`[[history]]`");
  }
  if (*seal != ledger_digest(history)) {
    throw table.error("ledger", "is not the SHA-256 of the history as it stands here",
                      "the history was edited or cut: take the file from a copy that was not");
  }
}

std::string digest_of_text(const std::string& text) {
  return sha256_hex(std::as_bytes(std::span(text)));
}

/// Of what it is now, whatever the file's comments and blanks.
std::string state_digest(const ModelFile& file) {
  return digest_of_text(format_model(file, false));
}

ModelFile read(const TomlTable& table) {
  require_a_model(table);
  table.expect({"kolsky_model", "kind", "bar_source", "gauges", "ledger", "state", "expressions",
                "effects", "history"});
  if (table.integer("kolsky_model") != kFormat) {
    throw table.error("kolsky_model", "is a format that this version does not know",
                      "make the model anew with `kolsky model new`");
  }
  ModelFile file;
  constexpr std::array kKinds{BenchKind::bar, BenchKind::shpb, BenchKind::impact};
  file.model.kind = kKinds.at(table.choice("kind", {"bar", "shpb", "impact"}));
  file.bar_source = table.optional_text("bar_source").value_or("");
  file.gauges = table.optional_texts("gauges").value_or(std::vector<std::string>{});
  const std::vector<TomlTable> expressions = table.tables("expressions");
  for (const TomlTable& own : expressions) {
    file.model.expressions.push_back(read_expression(own, file.model));
  }
  for (const TomlTable& own : table.tables("effects")) {
    EffectUse use = read_use(own, file.model);
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
  for (std::size_t i = 0; i < expressions.size(); ++i) {
    require_admissible(expressions[i], *file.model.expressions[i], file.model);
  }
  for (const TomlTable& own : table.tables("history")) {
    file.history.push_back(read_step(own));
  }
  require_sealed(table, file.history);
  const auto state = table.optional_text("state");
  file.edited_by_hand = !file.history.empty() && state != state_digest(file);
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
  } else if (use.effect->about().per_shot && !use.form_open && awaits_a_fit(use)) {
    text += "per_shot = false\n";
  }
  if (!use.prior_correlation.empty()) {
    text += "prior_correlation = [";
    for (std::size_t i = 0; i < use.prior_correlation.size(); ++i) {
      text += (i == 0 ? "" : ", ") + toml_number(use.prior_correlation[i]);
    }
    text += "]\n";
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
    if (value.bounds) {
      text += "bounds = [" + toml_number(value.bounds->front()) + ", " +
              toml_number(value.bounds->back()) + "]\n";
    }
    text += "unit = " + toml_quoted(parameters[p].unit) + "\n";
    text += std::string("free = ") + (value.free ? "true" : "false") + "\n";
  }
  return text;
}

std::vector<std::string> digests_of(const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> digests;
  for (const auto& file : files) {
    digests.push_back(digest_of_text(read_file_bytes(file, kMostCaptureBytes)));
  }
  return digests;
}

std::string digest_of_all(const std::vector<std::string>& digests) {
  Sha256 all;
  for (const std::string& own : digests) {
    all.add(std::as_bytes(std::span(own)));
  }
  return all.hex();
}

/// What belongs to a bench is often given for a model.
void require_a_model(const TomlTable& table) {
  if (!table.has("kolsky_model") && table.has("gauges")) {
    throw table.error("kolsky_model", "is not there: this is a bench file",
                      "make a model of the bench with `kolsky model new --bench`");
  }
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
  for (std::size_t i = 0; i < file.gauges.size(); ++i) {
    text += (i == 0 ? "gauges = [" : ", ") + toml_quoted(file.gauges[i]);
  }
  text += file.gauges.empty() ? "" : "]\n";
  if (with_history && !file.history.empty()) {
    text += "ledger = " + toml_quoted(ledger_digest(file.history)) + "\n";
    // What was edited has none until a step notes it.
    text += file.edited_by_hand ? "" : "state = " + toml_quoted(state_digest(file)) + "\n";
  }
  for (const auto& expression : file.model.expressions) {
    text += format_expression(expression->text());
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

std::string digest_of_files(const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> digests = digests_of(files);
  std::sort(digests.begin(), digests.end());
  return digest_of_all(digests);
}

bool is_digest_of(const std::string& digest, const std::vector<std::filesystem::path>& files) {
  std::vector<std::string> digests = digests_of(files);
  if (digest == digest_of_all(digests)) {
    return true;
  }
  std::sort(digests.begin(), digests.end());
  return digest == digest_of_all(digests);
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

ModelFile ModelFile::at(std::size_t steps) const {
  if (steps > history.size()) {
    throw InputError(fmt::format("step {}", steps),
                     fmt::format("is not there: the model has {}", history.size()),
                     fmt::format("give a number from 0 to {}; `kolsky model history` lists them",
                                 history.size()));
  }
  if (steps == history.size()) {
    return *this;
  }
  ModelFile file = parse_model(history[steps].before, fmt::format("history, step {}", steps + 1));
  file.history.assign(history.begin(), history.begin() + static_cast<std::ptrdiff_t>(steps));
  return file;
}

std::size_t ModelFile::first_alike(std::size_t steps) const {
  const auto digest = [&](std::size_t after) {
    return after < history.size() ? history[after].parent : state_digest(*this);
  };
  const std::string own = digest(steps);
  std::size_t first = 0;
  while (first < steps && digest(first) != own) {
    ++first;
  }
  return first;
}

void begin_step(ModelFile& file, const std::string& action, const std::string& when) {
  ModelStep step;
  step.action = action;
  step.when = when;
  step.software = KOLSKY_VERSION;
  step.edited_by_hand = std::exchange(file.edited_by_hand, false);
  step.before = format_model(file, false);
  step.parent = digest_of_text(step.before);
  file.history.push_back(std::move(step));
}

}  // namespace kolsky

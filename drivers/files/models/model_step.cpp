#include "drivers/files/models/model_step.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "drivers/files/models/toml_values.hpp"
#include "drivers/files/settings/toml_table.hpp"
#include "drivers/files/sha256.hpp"

namespace kolsky {

namespace {

std::string list_of(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) {
    list += (list.empty() ? "" : ", ") + toml_quoted(text);
  }
  return "[" + list + "]";
}

std::string line(const std::string& key, double value) {
  return key + " = " + toml_number(value) + "\n";
}

std::string line(const std::string& key, const std::string& text) {
  return text.empty() ? "" : key + " = " + toml_quoted(text) + "\n";
}

std::string line(const std::string& key, const std::vector<std::string>& texts) {
  return texts.empty() ? "" : key + " = " + list_of(texts) + "\n";
}

StepFit read_fit(const TomlTable& table) {
  table.expect(
      {"captures", "chi2_reduced", "degrees_of_freedom", "repeatable_share", "noise_floor_share"});
  return {table.integer("captures"), table.number("chi2_reduced"),
          table.number("degrees_of_freedom"), table.number("repeatable_share"),
          table.number("noise_floor_share")};
}

StepHeldOut read_held_out(const TomlTable& table) {
  table.expect({"before", "after", "floor"});
  return {table.number("before"), table.number("after"), table.number("floor")};
}

StepTest read_test(const TomlTable& table) {
  table.expect(
      {"effect", "strength", "sd", "unit", "log_p", "held_out_gain", "verdict", "tied_with"});
  return {table.text("effect"),
          table.number("strength"),
          table.number("sd"),
          table.text("unit"),
          table.number("log_p"),
          table.number("held_out_gain"),
          table.text("verdict"),
          table.optional_texts("tied_with").value_or(std::vector<std::string>{})};
}

std::string format_fit(const StepFit& fit) {
  return "[history.fit]\ncaptures = " + std::to_string(fit.captures) + "\n" +
         line("chi2_reduced", fit.chi2_reduced) +
         line("degrees_of_freedom", fit.degrees_of_freedom) +
         line("repeatable_share", fit.repeatable_share) +
         line("noise_floor_share", fit.noise_floor_share);
}

/// A number that is not finite says nothing and has no place in a file.
bool finite(const StepTest& test) {
  return std::isfinite(test.strength) && std::isfinite(test.sd) && std::isfinite(test.log_p) &&
         std::isfinite(test.held_out_gain);
}

std::string format_test(const StepTest& test) {
  return "[[history.tests]]\neffect = " + toml_quoted(test.effect) + "\n" +
         line("strength", test.strength) + line("sd", test.sd) +
         "unit = " + toml_quoted(test.unit) + "\n" + line("log_p", test.log_p) +
         line("held_out_gain", test.held_out_gain) + "verdict = " + toml_quoted(test.verdict) +
         "\n" + line("tied_with", test.tied_with);
}

/// @param before  the step's, as TOML has it
std::string step_text(const ModelStep& step, const std::string& before) {
  std::string text = "\n[[history]]\naction = " + toml_quoted(step.action) +
                     "\nwhen = " + toml_quoted(step.when) + "\n";
  text += line("note", step.note) + line("data_sha256", step.data_sha256) +
          line("software", step.software) + line("verdict", step.verdict) +
          line("added", step.added);
  if (!step.seeds.empty()) {
    std::string seeds;
    for (const double seed : step.seeds) {
      seeds += (seeds.empty() ? "" : ", ") + toml_number(seed);
    }
    text += "seeds = [" + seeds + "]\n";
  }
  text += step.edited_by_hand ? "edited_by_hand = true\n" : "";
  text += "parent = " + toml_quoted(step.parent) + "\nbefore = " + before + "\n";
  if (step.fit) {
    text += format_fit(*step.fit);
  }
  if (step.held_out) {
    text += "[history.held_out]\n" + line("before", step.held_out->before) +
            line("after", step.held_out->after) + line("floor", step.held_out->floor);
  }
  for (const StepTest& test : step.tests) {
    if (finite(test)) {
      text += format_test(test);
    }
  }
  return text;
}

}  // namespace

ModelStep read_step(const TomlTable& table) {
  table.expect({"action", "when", "note", "data_sha256", "software", "verdict", "added", "seeds",
                "edited_by_hand", "fit", "held_out", "tests", "parent", "before"});
  ModelStep step;
  step.action = table.text("action");
  step.when = table.text("when");
  step.note = table.optional_text("note").value_or("");
  step.data_sha256 = table.optional_text("data_sha256").value_or("");
  step.software = table.optional_text("software").value_or("");
  step.verdict = table.optional_text("verdict").value_or("");
  step.added = table.optional_texts("added").value_or(std::vector<std::string>{});
  if (table.has("seeds")) {
    step.seeds = table.numbers("seeds");
  }
  step.edited_by_hand = table.optional_flag("edited_by_hand").value_or(false);
  if (const auto fit = table.optional_table("fit")) {
    step.fit = read_fit(*fit);
  }
  if (const auto held_out = table.optional_table("held_out")) {
    step.held_out = read_held_out(*held_out);
  }
  for (const TomlTable& test : table.tables("tests")) {
    step.tests.push_back(read_test(test));
  }
  step.parent = table.text("parent");
  step.before = table.text("before");
  if (sha256_hex(std::as_bytes(std::span(step.before))) != step.parent) {
    throw table.error("before", "is not the text that `parent` has the SHA-256 of",
                      "the history was edited: take the file from a copy that was not");
  }
  return step;
}

std::string format_step(const ModelStep& step) {
  return step_text(step, toml_lines(step.before));
}

std::string ledger_digest(const std::vector<ModelStep>& history) {
  // As files had it before texts went by lines, so that theirs still hold.
  std::string text;
  for (const ModelStep& step : history) {
    text += step_text(step, toml_quoted(step.before));
  }
  return sha256_hex(std::as_bytes(std::span(text)));
}

}  // namespace kolsky

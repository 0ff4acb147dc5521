#include "clients/cli/model_ledger.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/model_text.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {

namespace {

JsonValue describe(const StepTest& test) {
  return JsonObject{{"effect", test.effect},
                    {"strength", test.strength},
                    {"sd", test.sd},
                    {"unit", test.unit},
                    {"log_p", test.log_p},
                    {"p_value", std::exp(test.log_p)},
                    {"held_out_gain", test.held_out_gain},
                    {"verdict", test.verdict},
                    {"tied_with", test.tied_with}};
}

bool certified(const StepTest& test) {
  return test.verdict == "named" || test.verdict == "tied";
}

/// Whether two steps did the same from the same beginning on the same data: one of them taken again
/// loses nothing.
bool same_step(const ModelStep& a, const ModelStep& b) {
  return a.parent == b.parent && a.action == b.action && a.data_sha256 == b.data_sha256 &&
         a.note == b.note;
}

bool begins_with(const std::vector<ModelStep>& history, const std::vector<ModelStep>& earlier) {
  return earlier.size() <= history.size() &&
         std::ranges::equal(earlier.begin(), earlier.end(), history.begin(),
                            history.begin() + static_cast<std::ptrdiff_t>(earlier.size()),
                            same_step);
}

/// @return the name that a model's file has now
std::string give_free_name(const std::filesystem::path& path) {
  std::filesystem::path kept;
  for (int n = 1; kept.empty() || !rename_without_overwriting(path, kept); ++n) {
    kept = path.parent_path() /
           fmt::format("{}.{}{}", path.stem().string(), n, path.extension().string());
  }
  return kept.string();
}

}  // namespace

std::string write_model(const std::filesystem::path& path, const ModelFile& file) {
  const std::string text = format_model(file);
  std::string kept;
  if (std::filesystem::exists(path)) {
    require_replaceable(path, text);
    if (!begins_with(file.history, read_model(path).history)) {
      kept = give_free_name(path);
    }
  }
  try {
    replace_file(path, text);
  } catch (const InputError&) {
    if (!kept.empty()) {
      static_cast<void>(rename_without_overwriting(kept, path));
    }
    throw;
  }
  return kept;
}

std::string kept_text(const std::string& name, const std::string& kept) {
  return kept.empty()
             ? ""
             : fmt::format("{} had a history of its own; with it, it is {} now\n", name, kept);
}

void add_kept(const std::string& kept, JsonObject& answer) {
  if (!kept.empty()) {
    answer.push_back({"kept", kept});
  }
}

ModelFile model_named(const std::string& name) {
  const auto at = name.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(name)) {
    return read_model(name);
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
  return file.at(std::stoul(step));
}

ModelFile model_to_continue(const std::string& name) {
  const auto at = name.rfind('@');
  if (at != std::string::npos && !std::filesystem::exists(name)) {
    const std::string path = name.substr(0, at);
    throw InputError(name, "is a step of a history, which this would go on from",
                     fmt::format("give {}, or `kolsky model revert {} --to {} -o ANOTHER.toml` "
                                 "first",
                                 path, path, name.substr(at + 1)));
  }
  return read_model(name);
}

std::vector<std::string> gauges_of(const Bench& bench) {
  std::vector<std::string> names;
  for (const Gauge& gauge : bench.gauges) {
    names.push_back(gauge.name);
  }
  return names;
}

void require_model_of(const Bench& bench, const Model& model, const std::string& name) {
  if (model.kind != bench.kind) {
    throw InputError(name,
                     "is a model of a bench of kind " + name_of(model.kind) +
                         ", and the captures are of one of kind " + name_of(bench.kind),
                     "make one with `kolsky model new --kind " + name_of(bench.kind) + "`");
  }
  const std::vector<std::string> gauges = gauges_of(bench);
  for (const EffectUse& use : model.effects) {
    if (!use.gauge.empty() && std::ranges::find(gauges, use.gauge) == gauges.end()) {
      throw InputError(
          name + ": effect " + use.id(),
          "names a gauge that the captures' bench does not have: its gauges are " +
              fmt::format("{}", fmt::join(gauges, ", ")),
          "take the effect out with `kolsky model remove`, or compare with captures of "
          "the bench that the model is of");
    }
  }
}

std::string edited_text(const ModelFile& file) {
  return file.edited_by_hand ? fmt::format("edited by hand after step {}", file.history.size())
                             : "";
}

JsonValue describe(const ModelStep& step) {
  JsonObject object{{"action", step.action},     {"when", step.when},
                    {"note", step.note},         {"data_sha256", step.data_sha256},
                    {"software", step.software}, {"parent", step.parent},
                    {"verdict", step.verdict},   {"added", step.added},
                    {"seeds", step.seeds},       {"edited_by_hand", step.edited_by_hand}};
  if (step.fit) {
    object.push_back({"fit", JsonObject{{"captures", step.fit->captures},
                                        {"chi2_reduced", step.fit->chi2_reduced},
                                        {"degrees_of_freedom", step.fit->degrees_of_freedom},
                                        {"repeatable_share", step.fit->repeatable_share},
                                        {"noise_floor_share", step.fit->noise_floor_share}}});
  }
  if (step.held_out) {
    object.push_back({"held_out", JsonObject{{"before", step.held_out->before},
                                             {"after", step.held_out->after},
                                             {"floor", step.held_out->floor}}});
  }
  JsonList tests;
  for (const StepTest& test : step.tests) {
    tests.push_back(describe(test));
  }
  object.push_back({"tests", std::move(tests)});
  return object;
}

std::string ledger_text(const ModelStep& step) {
  std::string text;
  if (step.edited_by_hand) {
    text += "      the file had been edited by hand; the step before lists that with its own\n";
  }
  if (!step.data_sha256.empty()) {
    text += fmt::format("      data {}..., kolsky {}\n", step.data_sha256.substr(0, 12),
                        step.software.empty() ? "of unknown version" : step.software);
  }
  if (step.fit) {
    text += fmt::format("      chi2 {:.4f} over {:.0f} degrees of freedom, {} captures\n",
                        step.fit->chi2_reduced, step.fit->degrees_of_freedom, step.fit->captures);
  }
  if (step.held_out) {
    const bool one_shot = step.fit && step.fit->captures == 1;
    text += fmt::format("      on held-out {} {:.4f} -> {:.4f}, noise alone {:.4f}\n",
                        one_shot ? "parts of the one record" : "shots", step.held_out->before,
                        step.held_out->after, step.held_out->floor);
  }
  for (const StepTest& test : step.tests) {
    if (!certified(test)) {
      continue;
    }
    text += fmt::format("      {} {}: {}, ln p {:.1f}\n", test.verdict, test.effect,
                        number_text(test.strength, test.sd, test.unit), test.log_p);
    for (const std::string& other : test.tied_with) {
      text += "        cannot be told from " + other + "\n";
    }
  }
  return text;
}

}  // namespace kolsky::cli

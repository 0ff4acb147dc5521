#include "processing/criticism/selftest/selftest.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <memory>
#include <mutex>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/judged_records.hpp"
#include "clients/cli/model_ledger.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/threads.hpp"
#include "clients/figure/layout.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

constexpr std::size_t kBarColumns = 40;
constexpr std::uint64_t kMostNulls = 10000;

struct Settings {
  JudgedRecords judged;
  std::string model;
  std::vector<std::string> effects;
  std::vector<std::string> sizes;
  std::optional<std::uint64_t> nulls;
  std::optional<std::uint64_t> seed;
};

constexpr const char* kOptimistic =
    "planted by the same models that look for it: a real effect never fits its model so well";

std::vector<double> sizes_of(const Settings& settings) {
  std::vector<double> sizes;
  for (const std::string& text : settings.sizes) {
    std::size_t read = 0;
    double size = NAN;
    try {
      size = std::stod(text, &read);
    } catch (const std::exception&) {
      read = 0;
    }
    if (read != text.size() || !std::isfinite(size) || size <= 0.0) {
      throw InputError("kolsky selftest: --sizes", "\"" + text + "\" is not a number above 0",
                       "give sizes off the effect's null in its unit, as 0.001 0.003");
    }
    sizes.push_back(size);
  }
  if (!sizes.empty() && settings.effects.size() != 1) {
    throw InputError("kolsky selftest: --sizes", "are in the unit of one effect",
                     "name that one with --effects");
  }
  return sizes;
}

/// Tells how far it is and how long it will take, from however many threads.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted) : wanted_(wanted), begun_(Clock::now()) {}

  void operator()(std::size_t done, std::size_t all) {
    const std::scoped_lock held(lock_);
    if (!wanted_ || done <= told_) {
      return;
    }
    told_ = done;
    const double seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    if (done == 1) {
      first_ = seconds;
      say(fmt::format("kolsky: 1 of {} diagnoses made", all), all == 1);
    } else if (done == all || seconds - said_ > every_s()) {
      said_ = seconds;
      const double each = (seconds - first_) / static_cast<double>(done - 1);
      say(fmt::format("kolsky: {} of {}, about {:.0f} s left", done, all,
                      each * static_cast<double>(all - done)),
          done == all);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double every_s() const { return rewrites_ ? 0.5 : 5.0; }
  /// On a terminal in the place of what was said before, in a file on a line of its own.
  void say(const std::string& text, bool last) const {
    std::cerr << (rewrites_ ? "\r" + padded_right(text, kColumns) : text)
              << (rewrites_ && !last ? "" : "\n") << std::flush;
  }
  static constexpr std::size_t kColumns = 60;
  const bool rewrites_ = terminal_of(STDERR_FILENO).interactive;

  std::mutex lock_;
  bool wanted_;
  Clock::time_point begun_;
  double first_ = 0.0;
  double said_ = 0.0;
  std::size_t told_ = 0;
};

JsonValue describe(const PlantedEffect& effect) {
  JsonList sizes;
  for (const PlantedSize& size : effect.sizes) {
    sizes.push_back(JsonObject{{"size", size.size},
                               {"multiple", size.multiple},
                               {"outcome", kolsky::name_of(size.outcome)},
                               {"found", size.found()},
                               {"said", size.said},
                               {"strength", size.strength},
                               {"sd", size.sd}});
  }
  return JsonObject{{"effect", effect.id},
                    {"parameter", effect.parameter},
                    {"unit", effect.unit},
                    {"smallest_detectable", effect.detectable},
                    {"smallest_identifiable", effect.identifiable},
                    {"smallest_found", effect.smallest_found()},
                    {"skipped", effect.skipped},
                    {"sizes", std::move(sizes)}};
}

JsonValue describe(const Selftest& result, std::uint64_t seed) {
  JsonList effects;
  for (const PlantedEffect& effect : result.effects) {
    effects.push_back(describe(effect));
  }
  JsonList power;
  for (const Selftest::Power& own : result.power()) {
    power.push_back(JsonObject{{"multiple", own.multiple},
                               {"found", static_cast<std::int64_t>(own.found)},
                               {"planted", static_cast<std::int64_t>(own.planted)}});
  }
  return JsonObject{
      {"untouched", JsonObject{{"verdict", kolsky::name_of(result.untouched)},
                               {"effects", result.untouched_effects}}},
      {"nulls", JsonObject{{"campaigns", static_cast<std::int64_t>(result.nulls)},
                           {"false_claims", static_cast<std::int64_t>(result.false_claims)},
                           {"unknown", static_cast<std::int64_t>(result.false_unknown)},
                           {"claimed", result.falsely_claimed}}},
      {"effects", std::move(effects)},
      {"power", std::move(power)},
      {"seed", seed},
      {"notes", std::vector<std::string>{kOptimistic}}};
}

std::string nulls_text(const Selftest& result) {
  std::string text = "untouched: " + kolsky::name_of(result.untouched);
  for (const std::string& id : result.untouched_effects) {
    text += " " + id;
  }
  text += "\n";
  if (result.untouched != DiagnosisVerdict::adequate) {
    text +=
        "  the model does not yet explain these captures; what follows is beside that misfit: add "
        "what is missing first\n";
  }
  text += fmt::format("noise drawn anew, nothing hidden: {} of {} claimed something",
                      result.false_claims, result.nulls);
  for (const std::string& id : result.falsely_claimed) {
    text += " (" + id + ")";
  }
  return text + (result.false_unknown > 0
                     ? fmt::format(", {} called unknown\n", result.false_unknown)
                     : "\n");
}

std::string effects_text(const Selftest& result) {
  std::string text = fmt::format("\n  {:<28} {:>12} {:>12} {:<8}  {}\n", "planted", "by theory",
                                 "found from", "", "outcome, smallest size first");
  for (const PlantedEffect& effect : result.effects) {
    if (!effect.skipped.empty()) {
      text += fmt::format("  {:<28} {}\n", effect.id, effect.skipped);
      continue;
    }
    std::string outcomes;
    for (const PlantedSize& size : effect.sizes) {
      outcomes += fmt::format("{}{:.2g}: {}", outcomes.empty() ? "" : ", ", size.size,
                              kolsky::name_of(size.outcome));
    }
    const double smallest = effect.smallest_found();
    text +=
        fmt::format("  {:<28} {:>12} {:>12} {:<8}  {}\n", effect.id,
                    std::isfinite(effect.identifiable) ? fmt::format("{:.2g}", effect.identifiable)
                                                       : "at no size",
                    std::isfinite(smallest) ? fmt::format("{:.2g}", smallest) : "none",
                    effect.unit == "-" ? "" : effect.unit, outcomes);
  }
  return text;
}

std::string power_text(const Selftest& result, bool colour) {
  const auto power = result.power();
  if (power.empty()) {
    return {};
  }
  std::string text =
      "\nthe power of this bench: found, by multiples of what theory calls "
      "identifiable\n";
  for (const Selftest::Power& own : power) {
    const double share = static_cast<double>(own.found) / static_cast<double>(own.planted);
    std::string bar;
    for (std::size_t i = 0; i < kBarColumns; ++i) {
      bar += static_cast<double>(i) < share * static_cast<double>(kBarColumns) ? "█" : "░";
    }
    text += fmt::format("  {:>6.3g} x  {}  {} of {}\n", own.multiple,
                        inked(bar, Ink::first, colour), own.found, own.planted);
  }
  return text;
}

int run(const Settings& settings, Context& context) {
  SelftestOptions options;
  options.effects = settings.effects;
  options.sizes = sizes_of(settings);
  options.nulls = settings.nulls.value_or(options.nulls);
  if (options.nulls > kMostNulls) {
    throw InputError("kolsky selftest: --nulls", fmt::format("are more than {}", kMostNulls),
                     "give fewer: each is a diagnosis");
  }
  options.seed = settings.seed.value_or(options.seed);
  options.band_limit_Hz = band_limit_of(settings.judged.band_limit_Hz);
  ProgressLine line(!context.json);
  options.progress = [&](std::size_t done, std::size_t all) { line(done, all); };
  const Model model = model_named(settings.model).model;
  const std::vector<Shot> shots = read_shots(settings.judged);
  if (!shots.empty()) {
    require_model_of(shots.front().bench, model, settings.model);
  }
  const Selftest result = selftest(shots, model, options, all_cores());
  if (context.json) {
    context.out << to_text(describe(result, options.seed)) << "\n";
    return kDone;
  }
  context.out << nulls_text(result) << effects_text(result)
              << power_text(result, context.terminal.colour) << "  note: " << kOptimistic << "\n";
  return kDone;
}

}  // namespace

Command selftest_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "selftest";
  command.purpose =
      "what `diagnose` would find on your own bench: effects planted into your captures\n"
      "In raw codes, the captures' own noise stays. Also how often it cries wolf, on noise drawn "
      "anew.\nA ball's diagnosis takes half a minute of a core: name --effects, or let it run.";
  command.examples =
      "  kolsky selftest shots --model m2.toml\n"
      "  kolsky selftest shots --model m2.toml --effects gauge-position:g3 --sizes 5e-4 1e-3 "
      "2e-3\n"
      "  kolsky selftest balls --model m.toml --effects core-nonlinearity --nulls 2\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of one bench, or folders of them", &s.judged.captures),
      needed("--model", "M.toml", "the model that explains them, the better the more it says",
             &s.model),
      option("--effects", "ID...", "what to plant; else one of each kind that these shots can show",
             &s.effects),
      option("--sizes", "SIZE...",
             "off the effect's null, in its unit; else 0.5, 1, 2 and 4 times what theory calls "
             "identifiable",
             &s.sizes),
      option("--nulls", "N", "campaigns of fresh noise in which nothing is, at most 10000; else 6",
             &s.nulls),
      option("--seed", "N", "of the fresh noise; else 1", &s.seed)};
  add_judged_options(s.judged, command.arguments);
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

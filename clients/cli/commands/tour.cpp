#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <ostream>
#include <random>
#include <sstream>

#include "clients/cli/command.hpp"
#include "clients/cli/program.hpp"
#include "clients/cli/reports/json_value.hpp"
#include "clients/cli/reports/model_text.hpp"
#include "clients/cli/reports/tour_story.hpp"
#include "clients/cli/threads.hpp"
#include "clients/figure/layout.hpp"
#include "clients/terminal/plot.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/models/model_file.hpp"
#include "drivers/simulated/hidden_campaign.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kShots = 6;
constexpr std::size_t kFewShots = 4;
constexpr int kPlotColumns = 100;
constexpr int kPlotRows = 10;

struct Settings {
  std::optional<std::uint64_t> seed;
  std::optional<std::string> folder;
  bool quick = false;
  bool pause = false;
  bool remove = false;
  bool shots_only = false;
  bool truth_only = false;
};

/// Where the tour happens; the program is in it while this lives.
class Workplace {
 public:
  explicit Workplace(const std::optional<std::string>& asked) : home_(fs::current_path()) {
    if (asked) {
      std::error_code failed;
      fs::create_directories(*asked, failed);
      if (failed || !fs::is_directory(*asked) || !fs::is_empty(*asked, failed)) {
        throw InputError("--folder " + *asked, "is not an empty folder, nor can it become one",
                         "give a name that is not taken");
      }
      folder_ = fs::canonical(*asked);
    } else {
      std::string name = (fs::temp_directory_path() / "kolsky-tour-XXXXXX").string();
      if (mkdtemp(name.data()) == nullptr) {
        throw InputError(name, "cannot be made", "give --folder");
      }
      folder_ = name;
    }
    fs::current_path(folder_);
  }
  ~Workplace() {
    std::error_code ignored;
    fs::current_path(home_, ignored);
  }
  Workplace(const Workplace&) = delete;
  Workplace& operator=(const Workplace&) = delete;

  [[nodiscard]] const fs::path& folder() const { return folder_; }
  void remove() const {
    fs::current_path(home_);
    fs::remove_all(folder_);
  }

 private:
  fs::path home_;
  fs::path folder_;
};

Hidden hidden_of(const HiddenTruth& truth) {
  return {truth.id, truth.parameter, truth.unit, truth.strength, truth.words, truth.in_library};
}

JsonValue describe(const Hidden& hidden) {
  return JsonObject{{"effect", hidden.id},           {"in_library", hidden.in_library},
                    {"parameter", hidden.parameter}, {"unit", hidden.unit},
                    {"strength", hidden.strength},   {"words", hidden.words}};
}

std::string shot_name(std::size_t shot) {
  return fmt::format("shot{:02}", shot + 1);
}

class Tour {
 public:
  Tour(const Settings& settings, Context& context)
      : settings_(settings), context_(context), place_(settings.folder) {}

  int run() {
    const auto begun = std::chrono::steady_clock::now();
    const std::uint64_t seed = settings_.seed ? *settings_.seed : std::random_device{}() % 100000U;
    campaign_ = draw_hidden_campaign(seed, settings_.quick ? kFewShots : kShots);
    hidden_ = hidden_of(campaign_.truth);
    if (settings_.shots_only) {
      return leave_shots(seed);
    }
    introduce(seed);
    shoot();
    import();
    begin_model();
    const ModelStep step = diagnose();
    follow_up(step);
    const TourVerdict verdict = judge(hidden_, step);
    reveal(verdict);
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
    conclude(seed, step, verdict, seconds);
    return kDone;
  }

 private:
  [[nodiscard]] bool silent() const { return context_.json; }

  void say(const std::string& text) {
    if (silent()) {
      return;
    }
    const int columns = std::min(kPlotColumns, std::max(40, context_.terminal.columns - 1));
    for (const std::string& line : wrapped(text, static_cast<std::size_t>(columns))) {
      context_.out << line << "\n";
    }
    context_.out << std::flush;
  }

  void chapter(const std::string& title) {
    if (silent()) {
      return;
    }
    if (settings_.pause && context_.terminal.interactive && !commands_.empty()) {
      context_.out << inked("-- Enter goes on --", Ink::dim, context_.terminal.colour)
                   << std::flush;
      std::string line;
      std::getline(std::cin, line);
    }
    context_.out << "\n" << inked(title, Ink::bold, context_.terminal.colour) << "\n\n";
  }

  /// Shows a command as a user would type it, and runs it by the same code.
  void command(const std::vector<std::string>& words, bool shown = true) {
    std::string text = "kolsky";
    for (const std::string& word : words) {
      text += " " + word;
    }
    commands_.push_back(text);
    if (shown && !silent()) {
      context_.out << inked("$ " + text, Ink::bold, context_.terminal.colour) << std::endl;
    }
    std::vector<std::string> run = words;
    if (silent()) {
      run.emplace_back("--json");  // and nothing of its progress on the terminal
    }
    std::ostringstream nowhere;
    std::ostringstream errors;
    const int code =
        run_program(run, silent() || !shown ? nowhere : context_.out, errors, context_.terminal);
    if (code != kDone) {
      throw InputError("kolsky tour", "the command \"" + text + "\" failed: " + errors.str(),
                       "what it worked on is in " + place_.folder().string());
    }
    if (shown && !silent()) {
      context_.out << "\n";
    }
  }

  /// What a laboratory would have after a morning: tables, a bench file and a log.
  int leave_shots(std::uint64_t seed) {
    write_tables();
    std::string log = "shot,temperature_K,striker_speed_m_per_s\n";
    for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
      log += fmt::format("{},{:.2f},{:.2f}\n", shot_name(n), campaign_.shots[n].temperature_K,
                         campaign_.shots[n].striker_speed_m_per_s);
    }
    replace_file("log.csv", log);
    if (silent()) {
      context_.out << to_text(
                          JsonObject{{"seed", seed},
                                     {"folder", place_.folder().string()},
                                     {"shots", static_cast<std::int64_t>(campaign_.shots.size())}})
                   << "\n";
    }
    say(fmt::format("{} tables of a simulated bar, bench.toml and log.csv are in {}",
                    campaign_.shots.size(), place_.folder().filename().string()));
    return kDone;
  }

  void introduce(std::uint64_t seed) {
    chapter("A bar, four gauges, and something that the bench file does not say");
    say(fmt::format("Seed {}: the same seed tells the same story. Everything happens in {}", seed,
                    place_.folder().string()));
    say(fmt::format(
        "A simulated PMMA bar is struck {} times. Perhaps a gauge is misplaced, an amplifier slow, "
        "the material richer than its model, or nothing at all is wrong; it was drawn at random "
        "and is told at the end. The simulation steps a rod through time and shares nothing with "
        "the analysis.",
        campaign_.shots.size()));
  }

  std::vector<std::string> write_tables() {
    std::vector<std::string> tables(campaign_.shots.size());
    all_cores().run(tables.size(), [&](std::size_t shot, std::size_t) {
      tables[shot] = shot_table(campaign_, shot);
    });
    replace_file("bench.toml", bench_toml(campaign_));
    for (std::size_t n = 0; n < tables.size(); ++n) {
      replace_file(shot_name(n) + ".csv", tables[n]);
    }
    return tables;
  }

  void shoot() {
    const std::vector<std::string> tables = write_tables();
    if (!silent()) {
      context_.out << "\n" << records_plot(tables.front()) << "\n";
    }
  }

  [[nodiscard]] std::string records_plot(const std::string& table) const {
    Panel panel{"shot01.csv, as the oscilloscope wrote it", {"time", "s"}, {"bridge", "V"}, {}};
    std::istringstream in(table);
    std::string line;
    std::getline(in, line);
    const std::vector<std::size_t> gauges{0, 1, campaign_.gain.size() - 1};
    for (const std::size_t gauge : gauges) {
      panel.series.push_back({"g" + std::to_string(gauge + 1), {}, {}});
    }
    while (std::getline(in, line)) {
      std::vector<double> values;
      std::istringstream cells(line);
      for (std::string cell; std::getline(cells, cell, ',');) {
        values.push_back(std::strtod(cell.c_str(), nullptr));
      }
      for (std::size_t i = 0; i < gauges.size(); ++i) {
        panel.series[i].x.push_back(values.front());
        panel.series[i].y.push_back(values[gauges[i] + 1]);
      }
    }
    return plot_text(panel, {std::min(kPlotColumns, context_.terminal.columns), kPlotRows},
                     context_.terminal.colour);
  }

  void import() {
    chapter("1. Tables become captures");
    fs::create_directory("shots");
    for (std::size_t n = 0; n < campaign_.shots.size(); ++n) {
      const HiddenShot& shot = campaign_.shots[n];
      command({"import", "csv", shot_name(n) + ".csv", "--bench", "bench.toml", "-o",
               "shots/" + shot_name(n) + ".h5", "--meta",
               fmt::format("temperature_K={:.2f}", shot.temperature_K)},
              n == 0);
    }
    say(fmt::format("The same for shot02 to {}, each with its own temperature.",
                    shot_name(campaign_.shots.size() - 1)));
  }

  void begin_model() {
    chapter("2. The model that everybody starts from");
    command({"model", "new", "--kind", "bar", "--bench", "bench.toml", "-o", "m.toml"});
    command({"fit", "shots", "--model", "m.toml", "-o", "m1.toml"});
    chapter("3. Where does it fail?");
    command({"compare", "shots", "--model", "m1.toml", "--report", "before.html"});
    say("The page before.html in the folder has every gauge and shot.");
  }

  ModelStep diagnose() {
    chapter("4. What is missing?");
    command(
        {"diagnose", "shots", "--model", "m1.toml", "-o", "m2.toml", "--report", "diagnosis.html"});
    ModelStep step = read_model("m2.toml").history.back();
    say(verdict_words(step));
    return step;
  }

  void follow_up(const ModelStep& step) {
    if (step.added.empty()) {
      return;
    }
    chapter("5. With it, does the error fall to the noise?");
    command({"compare", "shots", "--model", "m2.toml"});
    command({"model", "waterfall", "m2.toml", "shots", "--report", "waterfall.html"});
    command({"model", "diff", "m1.toml", "m2.toml"});
  }

  void reveal(const TourVerdict& verdict) {
    chapter("What was really there");
    const std::string text = truth_words(hidden_, verdict);
    say(text);
    const Model model = read_model("m2.toml").model;
    const std::vector<double> truth{campaign_.material.E1_Pa, campaign_.material.E2_Pa,
                                    campaign_.material.eta2_Pa_s};
    const EffectUse* bar = model.find("three-element-bar");
    std::string numbers;
    for (std::size_t p = 0; p < truth.size(); ++p) {
      const ModelValue& value = bar->values[p];
      const EffectParameter& parameter = bar->effect->about().parameters[p];
      numbers += fmt::format("  {:<10} found {}, truth {}", parameter.name,
                             number_text(value.value, value.sd, parameter.unit),
                             number_text(truth[p], 0.0, parameter.unit));
      numbers += value.sd > 0.0 ? fmt::format(": {:.1f} deviations off\n",
                                              std::abs(value.value - truth[p]) / value.sd)
                                : "\n";
    }
    if (!silent()) {
      context_.out << numbers;
    }
    replace_file("truth.txt", "# What was hidden\n" + text + "\n" + numbers);
  }

  void conclude(std::uint64_t seed, const ModelStep& step, const TourVerdict& verdict,
                double seconds) {
    const bool kept = !settings_.remove;
    if (silent()) {
      constexpr const char* kEnds[] = {"found", "among-tied", "rightly-quiet", "missed", "wrong"};
      context_.out << to_text(JsonObject{
                          {"seed", seed},
                          {"folder", kept ? place_.folder().string() : ""},
                          {"commands", commands_},
                          {"verdict", step.verdict},
                          {"effects", step.added},
                          {"truth", describe(hidden_)},
                          {"end", kEnds[static_cast<std::size_t>(verdict.end)]},
                          {"strength", verdict.strength ? JsonValue(*verdict.strength) : nullptr},
                          {"strength_sd", verdict.sd},
                          {"seconds", seconds}})
                   << "\n";
    } else {
      say("");
      say(fmt::format("{:.0f} seconds, {} commands.", seconds, commands_.size()));
      say(kept ? "All files stay in " + place_.folder().string() +
                     ": open diagnosis.html, try the commands, remove it when you like."
               : "The folder is removed.");
      say("Your own bench: docs/tutorial.md.");
    }
    if (!kept) {
      place_.remove();
    }
  }

  const Settings& settings_;
  Context& context_;
  Workplace place_;
  HiddenCampaign campaign_;
  Hidden hidden_;
  std::vector<std::string> commands_;
};

int tell(const Settings& settings, Context& context) {
  if (!settings.seed) {
    throw InputError("kolsky tour: --truth-only", "needs to know which campaign", "give --seed");
  }
  const HiddenTruth truth =
      draw_hidden_campaign(*settings.seed, settings.quick ? kFewShots : kShots).truth;
  if (context.json) {
    context.out << to_text(
                       JsonObject{{"seed", *settings.seed}, {"truth", describe(hidden_of(truth))}})
                << "\n";
    return kDone;
  }
  context.out << truth_words(hidden_of(truth)) << "\n";
  return kDone;
}

int run(const Settings& settings, Context& context) {
  if (settings.shots_only && (settings.truth_only || settings.remove || !settings.folder)) {
    throw InputError("kolsky tour: --shots-only", "leaves a campaign in a folder of yours",
                     "give --folder, and neither --remove nor --truth-only");
  }
  return settings.truth_only ? tell(settings, context) : Tour(settings, context).run();
}

}  // namespace

Command tour_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "tour";
  command.purpose =
      "a guided tour: a simulated campaign hides something; watch it being found\n"
      "Every step is a command that you could type, run for real, under a minute in all. What was "
      "hidden is\ntold at the end, whether it was found or not.";
  command.examples =
      "  kolsky tour\n"
      "  kolsky tour --seed 8 --pause\n"
      "  kolsky tour --seed 8 --shots-only --folder campaign\n";
  command.arguments = {
      option("--seed", "N", "which campaign; else any", &s.seed),
      option("--folder", "DIR", "where to work, kept; else a new folder among the temporary ones",
             &s.folder),
      flag("--quick", "four shots in place of six", &s.quick),
      flag("--pause", "wait for Enter before each step", &s.pause),
      flag("--remove", "remove the folder at the end", &s.remove),
      flag("--shots-only", "write the campaign's tables, bench file and log, and stop",
           &s.shots_only),
      flag("--truth-only", "tell what the campaign of this seed hides, and stop", &s.truth_only)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

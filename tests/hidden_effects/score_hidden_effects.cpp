// Draws campaigns with hidden effects, has `kolsky diagnose` find them, and prints how well it did.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <mutex>
#include <optional>
#include <thread>

#include "processing/base/error.hpp"
#include "tests/generators/measured_noise.hpp"
#include "tests/hidden_effects/case_draw.hpp"
#include "tests/hidden_effects/further_experiment.hpp"
#include "tests/hidden_effects/plain_faults.hpp"
#include "tests/hidden_effects/score_table.hpp"
#include "tests/hidden_effects/stress_curve.hpp"

namespace {

using namespace kolsky;
using namespace kolsky::scoring;

struct Settings {
  Plan plan;
  Analyser analyser;
  std::string out = "hidden-effects";
  std::string noise_table;
  int jobs = 2;
  int extra_nulls = 0;
  int only_bench = -1;
  bool draw_only = false;
  bool keep = false;
  bool refit = false;
  bool further = false;
  bool safeguards = false;
  bool gate = false;
};

/// As `kolsky diagnose --without` takes them.
constexpr std::array kSafeguards{"search-count", "held-out",   "shot-agreement", "own-strengths",
                                 "fitted-noise", "slow-noise", "backward",       "unknown"};

struct Scores {
  std::mutex mutex;
  std::vector<Verdict> verdicts;
  BySafeguard by_safeguard;
  std::exception_ptr failure;  ///< what ended a worker
  int left_out = 0;
};

bool went_well(const Verdict& verdict) {
  switch (verdict.kind) {
    case CaseKind::null:
      return verdict.answered == "adequate";
    case CaseKind::withheld:
      return verdict.answered == "unknown";
    case CaseKind::absorbed:
      return verdict.named.empty() && verdict.answered != "failed";
    case CaseKind::tied:
      return verdict.found == 1;
    case CaseKind::single:
    case CaseKind::two:
      return verdict.exact;
  }
  return false;
}

/// @return nothing where the generator cannot calculate what was drawn: that says nothing of the
/// analyser, and is counted by itself
std::optional<CaseFiles> written(const Settings& settings, const Case& drawn, Scores& scores) {
  try {
    return write_case(drawn, settings.out);
  } catch (const InputError& error) {
    const std::lock_guard lock(scores.mutex);
    std::cerr << fmt::format("{:<24}left out: {}\n", drawn.id, error.what());
    ++scores.left_out;
    return std::nullopt;
  }
}

/// Whether what it hides is large enough that the places must show it.
bool asks_for_places(const Case& drawn) {
  return drawn.kind == CaseKind::single && drawn.multiples.front() > 1.5;
}

/// @param bench  reckoned where it is needed first
void score_places(const Settings& settings, const Case& drawn, const CaseFiles& files,
                  std::optional<FailingPlaces>& bench, Verdict& verdict) {
  const Answer compared = compare_base(settings.analyser, files);
  if (compared.code != 0 || !compared.json.is_object()) {
    verdict.error += "compare: " + compared.error.substr(0, 300);
    return;
  }
  if (!bench) {
    bench.emplace(drawn.bare);
  }
  verdict.places =
      localisation(bench->of(drawn.campaign, places_of(compared.json)), marked_by(compared.json));
}

/// The same case without each of the safeguards.
void score_safeguards(const Settings& settings, const Case& drawn, const CaseFiles& files,
                      const Verdict& with_all, Scores& scores) {
  BySafeguard own{{"all", {with_all}}};
  for (const char* const name : kSafeguards) {
    Analyser without = settings.analyser;
    without.more += fmt::format(" --without {}", name);
    own[name].push_back(judge(drawn, diagnose(without, files)));
  }
  const std::lock_guard lock(scores.mutex);
  for (auto& [name, verdicts] : own) {
    scores.by_safeguard[name].push_back(std::move(verdicts.front()));
  }
}

void score_case(const Settings& settings, const Case& drawn, std::optional<FailingPlaces>& bench,
                Scores& scores) {
  const std::optional<CaseFiles> drawn_files = written(settings, drawn, scores);
  if (!drawn_files) {
    return;
  }
  const CaseFiles& files = *drawn_files;
  if (settings.draw_only) {
    return;
  }
  const Answer answer = diagnose(settings.analyser, files);
  Verdict verdict = judge(drawn, answer);
  if (settings.refit && verdict.exact) {
    judge_refit(verdict, drawn, refit(settings.analyser, files));
    if (drawn.campaign.split) {
      judge_curve(verdict, drawn, waterfall(settings.analyser, files));
    }
  }
  if (settings.safeguards) {
    score_safeguards(settings, drawn, files, verdict, scores);
  } else if (!settings.gate && asks_for_places(drawn)) {
    score_places(settings, drawn, files, bench, verdict);
  }
  if (settings.further && drawn.kind != CaseKind::two && verdict.found == 1 &&
      verdict.set_size > 1.0) {
    verdict.proposal = proposal_of(answer);
    if (const auto changed = changed_as_proposed(drawn.campaign, verdict.proposal)) {
      const Case further{drawn.id + "-next", drawn.kind, *changed, {}, drawn.multiples};
      const CaseFiles further_files = write_case(further, settings.out);
      verdict.tie_broken = judge(further, diagnose(settings.analyser, further_files)).exact;
      if (*verdict.tie_broken && !settings.keep) {
        std::filesystem::remove_all(further_files.folder);
      }
    }
  }
  const bool well = went_well(verdict);
  if (well && !settings.keep) {
    std::filesystem::remove_all(files.folder);
  }
  const std::lock_guard lock(scores.mutex);
  std::cerr << fmt::format("{:<24}{:<9}{:<6.1f}s {}\n", verdict.id, verdict.answered,
                           verdict.seconds, well ? "" : json_of(verdict)["truth"].dump());
  scores.verdicts.push_back(std::move(verdict));
}

void work(const Settings& settings, std::atomic<int>& next, Scores& scores) {
  const int benches = settings.plan.benches + settings.extra_nulls;
  for (int bench = next++; bench < benches; bench = next++) {
    if (settings.only_bench >= 0 && bench != settings.only_bench) {
      continue;
    }
    Plan plan = settings.plan;
    if (bench >= settings.plan.benches) {
      plan.nulls_per_bench = 1;
      plan.singles_per_bench = plan.tied_per_bench = plan.doubles_per_bench = 0;
      plan.absorbed_per_bench = plan.withheld_per_bench = 0;
    }
    const std::vector<Case> cases = draw_cases(plan, bench);
    std::optional<FailingPlaces> places;
    for (const Case& drawn : cases) {
      score_case(settings, drawn, places, scores);
    }
  }
}

/// The exit code of the gate: so few cases say nothing of shares, but plain faults show.
int gate(const std::vector<Verdict>& verdicts) {
  const std::vector<std::string> faults = plain_faults(verdicts);
  for (const std::string& fault : faults) {
    std::cout << fault << "\n";
  }
  std::cout << fmt::format("{} cases, {} plain faults\n", verdicts.size(), faults.size());
  return faults.empty() && !verdicts.empty() ? 0 : 1;
}

int report(const Settings& settings, Scores& scores) {
  std::vector<Verdict>& verdicts = scores.verdicts;
  std::ranges::sort(verdicts, {}, &Verdict::id);
  nlohmann::json all = nlohmann::json::array();
  for (const Verdict& verdict : verdicts) {
    all.push_back(json_of(verdict));
  }
  nlohmann::json places;
  for (const auto& [effect, own] : places_by_effect(verdicts)) {
    places[effect] = json_of(own);
  }
  std::ofstream(std::filesystem::path(settings.out) / "scores.json")
      << nlohmann::json{{"seed", settings.plan.seed}, {"cases", all}, {"places", places}}.dump(1)
      << "\n";
  if (settings.safeguards) {
    nlohmann::json without;
    for (auto& [name, own] : scores.by_safeguard) {
      std::ranges::sort(own, {}, &Verdict::id);
      for (const Verdict& verdict : own) {
        without[name].push_back(json_of(verdict));
      }
    }
    std::ofstream(std::filesystem::path(settings.out) / "safeguards.json")
        << without.dump(1) << "\n";
    std::cout << safeguards_text(scores.by_safeguard) << "\n";
  }
  const std::vector<Measure> table = measures(verdicts);
  std::cout << table_text(table) << "\nhidden -> said\n"
            << confusion_text(verdicts)
            << "\nfound, by multiple of the smallest identifiable size\n"
            << power_text(verdicts)
            << "\nplaces where the model fails without the effect, and what compare marks\n"
            << places_text(verdicts);
  if (scores.left_out > 0) {
    std::cout << fmt::format("\n{} cases left out: the generator could not calculate them\n",
                             scores.left_out);
  }
  if (settings.gate) {
    return gate(verdicts);
  }
  return std::ranges::all_of(table, [](const Measure& one) { return !one.got || one.met; }) ? 0 : 1;
}

int run(Settings& settings) {
  if (!settings.noise_table.empty()) {
    settings.plan.measured_noise = testing::measured_noise(settings.noise_table);
  }
  std::filesystem::create_directories(settings.out);
  std::atomic<int> next = 0;
  Scores scores;
  std::vector<std::jthread> workers;
  for (int i = 0; i < settings.jobs; ++i) {
    workers.emplace_back([&] {
      try {
        work(settings, next, scores);
      } catch (...) {
        next = std::numeric_limits<int>::max() / 2;  // the others end with what they are at
        const std::lock_guard lock(scores.mutex);
        scores.failure = std::current_exception();
      }
    });
  }
  workers.clear();
  if (scores.failure) {
    std::rethrow_exception(scores.failure);
  }
  return settings.draw_only ? 0 : report(settings, scores);
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  bool fast = false;
  bool full = false;
  CLI::App app(
      "Draws campaigns with hidden effects, runs `kolsky diagnose` on each and prints the score.\n"
      "Exit code 1 where a measure falls short.");
  app.add_option("--kolsky", settings.analyser.program, "the program")->required();
  app.add_option("--out", settings.out, "folder for cases, truths and scores.json");
  app.add_option("--seed", settings.plan.seed);
  app.add_option("--benches", settings.plan.benches);
  app.add_option("--singles", settings.plan.singles_per_bench, "per bench");
  app.add_option("--tied", settings.plan.tied_per_bench, "per bench");
  app.add_option("--doubles", settings.plan.doubles_per_bench, "per bench");
  app.add_option("--withheld", settings.plan.withheld_per_bench, "per bench");
  app.add_option("--absorbed", settings.plan.absorbed_per_bench, "per bench");
  app.add_option("--nulls", settings.extra_nulls, "further benches with nothing hidden");
  app.add_option("--jobs", settings.jobs);
  app.add_option("--timeout", settings.analyser.timeout_s, "s per command");
  app.add_option("--more", settings.analyser.more, "further arguments of diagnose");
  app.add_option("--noise", settings.noise_table,
                 "a record whose quiet beginning is used as noise: TABLE.csv:COLUMN:ROWS");
  app.add_option("--bench", settings.only_bench, "only this one, as a failed case's id has it");
  CLI::Option* split = app.add_flag("--split", settings.plan.split, "split bars in place of bars");
  CLI::Option* soft =
      app.add_flag("--soft", settings.plan.soft, "with rubbers between them")->needs(split);
  app.add_flag("--low-loss", settings.plan.low_loss, "with solids that relax little between them")
      ->needs(split)
      ->excludes(soft);
  app.add_flag("--refit", settings.refit, "fit again with what is named, judge the moduli");
  app.add_flag("--further", settings.further, "make the experiments proposed to break ties");
  app.add_flag("--safeguards", settings.safeguards,
               "every case without each of the diagnosis' safeguards, too");
  app.add_flag("--keep", settings.keep, "keep the folders of cases that went well");
  app.add_flag("--draw-only", settings.draw_only, "write the campaigns and stop");
  app.add_flag("--short", fast, "a few small campaigns");
  app.add_flag("--gate", settings.gate,
               "single effects at four times their smallest identifiable size; exit code 1 only\n"
               "where something is claimed falsely or a clear effect is missed");
  app.add_flag("--full", full, "2000 nulls and 60 benches");
  CLI11_PARSE(app, argc, argv);
  if (fast) {
    settings.plan.quick = true;
    settings.plan.benches = 1;
    settings.plan.singles_per_bench = 3;
    settings.plan.tied_per_bench = 0;
    settings.plan.doubles_per_bench = settings.plan.absorbed_per_bench = 0;
  }
  if (settings.gate) {
    settings.plan.least_multiple = kClear;
  }
  if (full) {
    settings.plan.benches = 60;
    settings.plan.singles_per_bench = 12;
    settings.plan.doubles_per_bench = 3;
    settings.plan.withheld_per_bench = 2;
    settings.extra_nulls = 2000 - settings.plan.benches;
  }
  try {
    return run(settings);
  } catch (const InputError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}

// Draws impacts with hidden effects, has `kolsky diagnose` find them, and prints how well it did.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iostream>
#include <mutex>
#include <random>
#include <thread>

#include "tests/generators/campaign_files.hpp"
#include "tests/generators/impact_campaign.hpp"
#include "tests/hidden_effects/plain_faults.hpp"
#include "tests/hidden_effects/score_table.hpp"

namespace {

using namespace kolsky;
using namespace kolsky::scoring;
using testing::ImpactWishes;

constexpr double kModulus_sd = 0.015;  ///< of every material number, relative, as filed

struct Settings {
  Analyser analyser;
  std::string out = "hidden-impacts";
  std::string only;
  std::uint64_t seed = 1;
  int repeats = 1;
  int nulls = 3;
  int jobs = 1;
  std::vector<std::size_t> across{7, 10};  ///< least and most of the generator's mesh
  std::vector<double> speeds_m_per_s;      ///< none: three, drawn for every case
  double size = 1.0;                       ///< of every strength, over the usual
  bool held = false;                       ///< materials
  bool quick = false;
  bool gate = false;
};

/// What can be hidden, in the sizes that are tried. Friction and what is off centre come in one.
struct Kind {
  testing::HiddenEffect effect;
  void (*hide)(double strength, ImpactWishes& wishes);
  bool sized = true;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {{"core-nonlinearity", "", 0.6, {}}, [](double b, ImpactWishes& w) { w.core_b = b; }},
      {{"core-nonlinearity", "", 0.3, {}}, [](double b, ImpactWishes& w) { w.core_b = b; }},
      {{"core-nonlinearity", "", -0.4, {}}, [](double b, ImpactWishes& w) { w.core_b = b; }},
      {{"core-second-relaxation", "", 2e-9, {}},
       [](double D, ImpactWishes& w) {
         w.core_D_per_Pa = D;
         w.core_tau_s = 1.5e-4;
       }},
      {{"cover-nonlinearity", "", 6.0, {}}, [](double b, ImpactWishes& w) { w.cover_b = b; }},
      {{"cover-second-relaxation", "", 2e-9, {}},
       [](double D, ImpactWishes& w) {
         w.cover_D_per_Pa = D;
         w.cover_tau_s = 1e-4;
       }},
      {{"contact-friction", "", 0.0, {}},
       [](double mu, ImpactWishes& w) { w.friction = mu; },
       false},
      {{"bridge-nonlinearity", "", 240.0, {}}, [](double b, ImpactWishes& w) { w.bridge_b = b; }},
      {{"off-centre-contact", "", 4e-3, {}},
       [](double d, ImpactWishes& w) { w.offset_m = d; },
       false},
      {{"bending", "", 1e-4, {}}, [](double chi, ImpactWishes& w) { w.bending_m = chi; }}};
  return all;
}

/// Which of these are hidden together.
constexpr std::array<std::pair<std::size_t, std::size_t>, 4> kPairs{
    {{0, 7}, {2, 3}, {3, 7}, {0, 6}}};

struct Draw {
  Case drawn;
  ImpactWishes wishes;
};

/// Other speeds, friction, mesh and noise for every case; materials within what is filed of them.
ImpactWishes drawn_wishes(std::uint64_t seed, const Settings& settings) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  ImpactWishes wishes;
  wishes.seed = random();
  const double slowest = between(20.0, 33.0);
  const double fastest = between(44.0, 52.0);
  wishes.speeds_m_per_s = {slowest, std::sqrt(slowest * fastest), fastest};
  if (!settings.speeds_m_per_s.empty()) {
    wishes.speeds_m_per_s = settings.speeds_m_per_s;
  }
  wishes.shots = std::uniform_int_distribution<std::size_t>(3, 5)(random);
  wishes.speed_error = 1e-3;
  wishes.rebound_error = between(1e-3, 2e-3);
  wishes.noise_strain = between(0.5e-6, 1.5e-6);
  wishes.friction = between(0.2, 0.35);
  wishes.across = std::uniform_int_distribution<std::size_t>(settings.across.front(),
                                                             settings.across.back())(random);
  for (double& modulus : wishes.moduli) {
    modulus = settings.held ? 1.0 : 1.0 + kModulus_sd * normal(random);
  }
  return wishes;
}

std::vector<Draw> draws_of(const Settings& settings) {
  std::vector<Draw> list;
  const auto add = [&](std::string id, CaseKind kind) -> Draw& {
    Draw& own = list.emplace_back();
    own.wishes = drawn_wishes(1000 * settings.seed + list.size(), settings);
    own.drawn.id = std::move(id);
    own.drawn.kind = kind;
    return own;
  };
  for (int n = 0; n < settings.nulls; ++n) {
    add(fmt::format("null-{}", n), CaseKind::null);
  }
  const auto hide = [&](const Kind& kind, Draw& own) {
    testing::HiddenEffect effect = kind.effect;
    effect.strength *= kind.sized ? settings.size : 1.0;
    kind.hide(effect.strength, own.wishes);
    own.drawn.campaign.effects.push_back(effect);
  };
  const auto called = [&](const Kind& kind) {
    return fmt::format("{}={:g}", kind.effect.id,
                       kind.effect.strength * (kind.sized ? settings.size : 1.0));
  };
  for (int n = 0; n < settings.repeats; ++n) {
    for (const Kind& kind : kinds()) {
      hide(kind, add(fmt::format("{}-{}", called(kind), n), CaseKind::single));
    }
    for (const auto& [first, second] : kPairs) {
      const Kind& one = kinds()[first];
      const Kind& other = kinds()[second];
      Draw& own = add(fmt::format("{}+{}-{}", called(one), called(other), n), CaseKind::two);
      hide(one, own);
      hide(other, own);
    }
  }
  std::erase_if(list, [&](const Draw& own) { return !own.drawn.id.starts_with(settings.only); });
  return list;
}

/// What a Hopkinson bar would have said of the material: the paper's numbers within a deviation.
std::filesystem::path write_material(const std::filesystem::path& file, double density_kg_m3,
                                     double poisson_ratio, std::array<double, 3> numbers) {
  std::ofstream out(file);
  out << fmt::format("density_kg_m3 = {}\npoisson_ratio = {}\n", density_kg_m3, poisson_ratio);
  const std::array names{"E1_Pa", "E2_Pa", "eta2_Pa_s"};
  for (std::size_t p = 0; p < names.size(); ++p) {
    out << fmt::format("{} = {}\n{}_sd = {}\n", names.at(p), numbers.at(p), names.at(p),
                       kModulus_sd * numbers.at(p));
  }
  return file;
}

CaseFiles write_impacts(const Draw& own, const Settings& settings) {
  const std::filesystem::path root = settings.out;
  CaseFiles files;
  files.folder = root / "cases" / own.drawn.id;
  std::filesystem::remove_all(files.folder);  // what an earlier run left of the same case
  files.bench = files.folder / "bench.toml";
  files.truth = root / "truth" / (own.drawn.id + ".json");
  files.kind = "impact";
  files.captures = testing::write_campaign({.folder = files.folder, .tables = false},
                                           testing::impact_shots(own.wishes));
  if (!settings.held) {
    files.core = write_material(files.folder / "core.toml", 1140.0, 0.376, {121e6, 143e6, 2860.0});
    files.cover = write_material(files.folder / "cover.toml", 960.0, 0.319, {987e6, 452e6, 6020.0});
  }
  std::filesystem::create_directories(files.truth.parent_path());
  nlohmann::json truth{
      {"effects", nlohmann::json::array()}, {"moduli", own.wishes.moduli},
      {"across", own.wishes.across},        {"speeds_m_per_s", own.wishes.speeds_m_per_s},
      {"friction", own.wishes.friction},    {"seed", own.wishes.seed}};
  for (const testing::HiddenEffect& effect : own.drawn.campaign.effects) {
    truth["effects"].push_back({{"effect", effect.name()}, {"strength", effect.strength}});
  }
  std::ofstream(files.truth) << truth.dump(2) << "\n";
  return files;
}

/// Rms of what the model found leaves at the highest speed, in percent of the peak, and what noise
/// leaves there.
std::string left_of(const Answer& comparison) {
  if (!comparison.json.contains("speeds")) {
    return {};
  }
  const nlohmann::json& fastest = comparison.json["speeds"].back();
  return fmt::format("{:.2f}/{:.2f}", fastest["rms_percent_of_peak"].get<double>(),
                     fastest["noise_percent_of_peak"].get<double>());
}

std::string line_of(const Verdict& verdict, const std::string& left) {
  std::string sets;
  for (const auto& members : verdict.sets) {
    sets += (sets.empty() ? "" : " + ") + fmt::format("{}", fmt::join(members, " ~ "));
  }
  const auto number = [](const std::optional<double>& value) {
    return value ? fmt::format("{:.2f}", *value) : std::string();
  };
  return fmt::format("{:<32}{:<10}{:>4.0f} s {:>6} {:>6} {:>10}  {}\n", verdict.id,
                     verdict.answered, verdict.seconds, number(verdict.closure),
                     number(verdict.strength_in_sd), left, sets);
}

std::string summary_of(const std::vector<Verdict>& verdicts) {
  int nulls = 0;
  int claims = 0;
  int hidden = 0;
  int found = 0;
  int exact = 0;
  int silent = 0;
  int within = 0;
  int strengths = 0;
  for (const Verdict& verdict : verdicts) {
    const bool null = verdict.kind == CaseKind::null;
    nulls += null ? 1 : 0;
    hidden += null ? 0 : 1;
    claims += verdict.named.empty() || (!null && verdict.found > 0) ? 0 : 1;
    found += verdict.found;
    exact += verdict.exact ? 1 : 0;
    silent += !null && verdict.named.empty() ? 1 : 0;
    if (verdict.strength_in_sd) {
      ++strengths;
      within += std::abs(*verdict.strength_in_sd) < 2.0 ? 1 : 0;
    }
  }
  return fmt::format(
      "{} nulls, {} hidden: {} false claims, the truth in the set {}, by its name alone {}, "
      "nothing "
      "claimed {}; strength within two deviations {} of {}\n",
      nulls, hidden, claims, found, exact, silent, within, strengths);
}

/// The exit code of the gate. Its cases are of seeds at which what is hidden shows: each has to
/// stand in a set, and nothing else may be claimed.
int gate(std::vector<Verdict> verdicts) {
  for (Verdict& verdict : verdicts) {
    verdict.multiples.assign(verdict.truth.size(), kClear);
  }
  const std::vector<std::string> faults = plain_faults(verdicts);
  for (const std::string& fault : faults) {
    std::cout << fault << "\n";
  }
  std::cout << fmt::format("{} cases, {} plain faults\n", verdicts.size(), faults.size());
  return faults.empty() && !verdicts.empty() ? 0 : 1;
}

int run(const Settings& settings) {
  const std::vector<Draw> draws = draws_of(settings);
  std::vector<Verdict> verdicts(draws.size());
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;
  std::cout << fmt::format("{:<32}{:<10}{:>6} {:>6} {:>6} {:>10}  {}\n", "hidden", "said", "",
                           "closed", "z", "left/noise", "claimed (~ tied)");
  const auto work = [&] {
    for (std::size_t i = next++; i < draws.size(); i = next++) {
      const CaseFiles files = write_impacts(draws[i], settings);
      verdicts[i] = judge(draws[i].drawn, diagnose(settings.analyser, files));
      const std::string left =
          settings.quick ? "" : left_of(compare_found(settings.analyser, files));
      const std::lock_guard lock(mutex);
      std::cout << line_of(verdicts[i], left) << std::flush;
    }
  };
  std::vector<std::jthread> workers;
  for (int i = 0; i < settings.jobs; ++i) {
    workers.emplace_back(work);
  }
  workers.clear();
  nlohmann::json all = nlohmann::json::array();
  for (const Verdict& verdict : verdicts) {
    all.push_back(json_of(verdict));
  }
  std::ofstream(std::filesystem::path(settings.out) / "scores.json")
      << nlohmann::json{{"seed", settings.seed}, {"cases", all}}.dump(1) << "\n";
  std::cout << "\n" << summary_of(verdicts);
  return settings.gate ? gate(std::move(verdicts)) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  settings.analyser.timeout_s = 900.0;
  CLI::App app(
      "Draws impacts with hidden effects by a solver of its own, runs `kolsky diagnose` on each "
      "and "
      "prints what it said. A case takes a minute on a core.");
  app.add_option("--kolsky", settings.analyser.program, "the program")->required();
  app.add_option("--out", settings.out, "folder for cases, truths and scores.json");
  app.add_option("--seed", settings.seed);
  app.add_option("--repeats", settings.repeats, "of every effect and size");
  app.add_option("--nulls", settings.nulls, "campaigns with nothing hidden");
  app.add_option("--only", settings.only, "cases whose name begins with this");
  app.add_option("--jobs", settings.jobs);
  app.add_option("--across", settings.across,
                 "cells of the generator's mesh, or least and most of them, else 7 to 10: 24 take "
                 "minutes a case and leave no error of its own that noise does not hide")
      ->expected(1, 2);
  app.add_option("--speeds", settings.speeds_m_per_s, "m/s, of every case, else three are drawn");
  app.add_option("--size", settings.size, "of every hidden strength, over the usual");
  app.add_flag("--held", settings.held, "materials as filed, and not fitted");
  app.add_flag("--gate", settings.gate,
               "fail where something false is claimed, or the truth is in no set");
  app.add_flag("--quick", settings.quick, "do not ask what the model found leaves");
  app.add_option("--timeout", settings.analyser.timeout_s, "s per command");
  CLI11_PARSE(app, argc, argv);
  try {
    return run(settings);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}

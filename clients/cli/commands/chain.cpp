#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <ostream>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/bar_options.hpp"
#include "clients/cli/captures.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/chain_run.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/slow_work.hpp"
#include "clients/cli/threads.hpp"
#include "clients/report/svg.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/better_solid.hpp"
#include "processing/impact/impact.hpp"

namespace kolsky::cli {
namespace {

constexpr const char* kPlace = "kolsky chain: ";
constexpr double kWithoutMeasurement_Hz = 50e3;

struct Settings {
  std::vector<std::string> bar_shots;
  std::optional<std::string> bar_solid;
  std::optional<std::string> bar_model;
  std::vector<std::string> core_shots;
  std::vector<std::string> cover_shots;
  std::vector<std::string> ball_shots;
  std::optional<std::string> bench;
  std::optional<std::string> reading;
  std::optional<std::string> law;
  std::optional<double> friction;
  std::optional<std::uint64_t> draws;
  std::optional<std::uint64_t> elements;
  std::optional<double> speed;
  std::optional<std::string> svg;
};

void say(const std::string& text) {
  std::cerr << "kolsky chain: " << text << std::endl;
}

// For who watches; a log gets only what takes long.
void say_to_a_person(const std::string& text) {
  if (terminal_of(2).interactive) {
    say(text);
  }
}

void require_kind(const std::vector<Shot>& shots, BenchKind kind, const char* option,
                  const char* name) {
  for (const Shot& shot : shots) {
    if (shot.bench.kind != kind) {
      throw InputError(shot.id + ": kind", std::string("is not \"") + name + "\"",
                       std::string("give other captures with ") + option);
    }
  }
}

std::uint64_t within(const std::optional<std::uint64_t>& count, std::uint64_t least,
                     std::uint64_t most, std::uint64_t otherwise, const char* name) {
  const std::uint64_t value = count.value_or(otherwise);
  if (value < least || value > most) {
    throw InputError(std::string(kPlace) + name, fmt::format("is outside {} to {}", least, most),
                     "give a count within");
  }
  return value;
}

PredictionOptions options_of(const Settings& settings) {
  PredictionOptions options;
  if (settings.reading) {
    options.reading = impact::reading_named(*settings.reading, std::string(kPlace) + "--reading");
  }
  if (settings.law) {
    options.law = impact::finite_strain_named(*settings.law, std::string(kPlace) + "--law");
  }
  options.friction = settings.friction.value_or(options.friction);
  if (!(options.friction >= 0.0 && options.friction <= 2.0)) {
    throw InputError(std::string(kPlace) + "--friction", "is outside 0 to 2",
                     "give the coefficient between ball and bar, as 0.3");
  }
  options.draws = within(settings.draws, 8, 2000, options.draws, "--draws");
  options.elements = within(settings.elements, 200, 20000, options.elements, "--elements");
  options.fine_elements = std::max(options.fine_elements, 4 * options.elements);
  return options;
}

/// What the specimens' bars are, with what is not known of it.
struct Bars {
  BarPrior prior{paper_pmma()};
  std::optional<double> band_limit_Hz;
  std::string name;  ///< of what they were given by; empty: by the captures
};

Bars bars_of(const Settings& settings, ChainRun& run) {
  if (settings.bar_solid && settings.bar_shots.empty()) {
    throw InputError(std::string(kPlace) + "--bar-solid", "is of the bar that --bar-shots identify",
                     "give those shots, or leave it out");
  }
  if (!settings.bar_shots.empty() && settings.bar_model) {
    throw InputError(std::string(kPlace) + "--bar-model", "is given beside --bar-shots",
                     "keep one of them");
  }
  if (settings.bar_model) {
    const BarModelFile file = read_bar_model(*settings.bar_model);
    run.bars = file.name;
    return {file.prior, file.band_limit_Hz, file.name};
  }
  if (settings.bar_shots.empty()) {
    run.bars =
        "as the specimens' captures have them: elastic, their own bar model, or the paper's PMMA";
    return {};
  }
  const std::vector<Shot> shots = captured_shots(settings.bar_shots);
  require_kind(shots, BenchKind::bar, "--bar-shots", "bar");
  say_to_a_person(fmt::format("identifying the bar from {} shots", shots.size()));
  BarIdentificationOptions options;
  options.solid = solid_asked(settings.bar_solid);
  run.bar = identify_bar(shots, options, all_cores());
  run.bars = fmt::format("identified from {} shots", shots.size());
  const Material material =
      material_to_file(*run.bar, shots.front().bench.input, "kolsky chain, " + run.bars);
  return {BarPrior(material), material.identified->band_limit_Hz,
          std::string(kPlace) + "--bar-shots"};
}

SpecimenFit fit_of(const std::vector<Shot>& shots, const Bars& bars, const char* part) {
  say_to_a_person(fmt::format("identifying the {} from {} shots", part, shots.size()));
  const bool own = bars.name.empty();
  for (const Shot& shot : shots) {
    if (!own) {
      require_bar_model_holds(bars.prior.material, shot, bars.name);
    }
  }
  if (!own) {
    for (const std::string& doubt : doubts_of(bars.prior.material, shots.front())) {
      say_to_a_person("bars " + doubt);
    }
  }
  const BarPrior prior =
      own && shots.front().bar_model ? BarPrior(*shots.front().bar_model) : bars.prior;
  SpecimenFitOptions options;
  options.most_band_Hz = bars.band_limit_Hz;
  return fit_specimen(shots, prior, options);
}

/// What the specimens' bench says of the material before anything is identified.
Material filed_material(const std::vector<Shot>& shots, const char* option) {
  const Specimen& specimen = *shots.front().bench.specimen;
  if (!specimen.density_kg_m3 || !specimen.poisson_ratio) {
    throw InputError(shots.front().id + ": specimen",
                     "lacks the density or Poisson's ratio that a ball of it needs",
                     std::string("file both in the bench of ") + option);
  }
  Material material;
  material.density_kg_m3 = *specimen.density_kg_m3;
  material.poisson_ratio = *specimen.poisson_ratio;
  material.source = option;
  return material;
}

MaterialPosterior posterior_of(const SpecimenFit& fit, Material material) {
  MaterialPosterior posterior{std::move(material), {}};
  posterior.material.parameters = measured_of(fit.parameters);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      posterior.covariance[i][j] = fit.covariance[i][j];
    }
  }
  return posterior;
}

bool alike(const Measured& a, const Measured& b) {
  return a.value == b.value && a.sd == b.sd;
}

/// Whether two specimens were on the same bars with the same gauges: what is filed of them wrongly
/// is then wrong for both.
bool same_bench(const Bench& a, const Bench& b) {
  const auto same_bar = [](const Bar& x, const Bar& y) {
    return alike(x.length_m, y.length_m) && alike(x.diameter_m, y.diameter_m) &&
           alike(x.density_kg_m3, y.density_kg_m3) && alike(x.poisson_ratio, y.poisson_ratio);
  };
  if (!same_bar(a.input, b.input) || !same_bar(*a.output, *b.output) ||
      a.gauges.size() != b.gauges.size()) {
    return false;
  }
  return std::equal(
      a.gauges.begin(), a.gauges.end(), b.gauges.begin(), [](const Gauge& x, const Gauge& y) {
        return x.name == y.name && x.bar == y.bar && alike(x.position_m, y.position_m);
      });
}

/// Whether the moduli of both specimens' bars are one and the same identification.
bool same_bars(const std::vector<Shot>& core, const std::vector<Shot>& cover,
               const Settings& settings) {
  if (!settings.bar_shots.empty() || settings.bar_model) {
    return true;
  }
  const auto& a = core.front().bar_model;
  const auto& b = cover.front().bar_model;
  return a.has_value() == b.has_value() &&
         (!a || (a->solid == b->solid && std::ranges::equal(a->parameters, b->parameters, alike)));
}

/// The covariance of two fits by what they share: unit deviations of the bars' moduli and of a
/// bench that both specimens were on. A fit is off by `by_bench` times what these are off by.
std::array<std::array<double, 3>, 3> between(const SpecimenFit& core, const SpecimenFit& cover,
                                             bool same_bars, bool same_bench) {
  std::array<std::array<double, 3>, 3> sum{};
  for (std::size_t a = 0; a < core.bench.size(); ++a) {
    const std::string& name = core.bench[a].name;
    const bool shared =
        name.starts_with("bar-model:") ? same_bars : same_bench && !name.starts_with("specimen-");
    for (std::size_t b = 0; b < cover.bench.size(); ++b) {
      for (std::size_t i = 0; shared && cover.bench[b].name == name && i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
          sum[i][j] += core.by_bench[i][a] * cover.by_bench[j][b];
        }
      }
    }
  }
  return sum;
}

/// The mean over repeats; its deviation is a single shot's, as what the shots share does not
/// average out, or that of the mean, whichever is more.
template <typename Member>
std::optional<Compared> compared(const Repeated& repeats, const BallRepeats& group,
                                 const std::vector<BallImpact>& impacts, const Member& member,
                                 const Foretold& foretold) {
  if (repeats.count == 0) {
    return std::nullopt;
  }
  double own = 0.0;
  for (const std::size_t i : group.members) {
    own = std::max(own, member(impacts[i]));
  }
  const double of_mean = repeats.sd / std::sqrt(static_cast<double>(repeats.count));
  return Compared{{repeats.mean, std::max(own, of_mean)}, foretold};
}

double sd_of(const std::optional<Measured>& number) {
  return number ? number->sd : 0.0;
}

void compare(ChainSpeed& speed, const std::vector<BallImpact>& impacts) {
  const BallRepeats& group = speed.measured;
  const BallPrediction& foretold = speed.foretold;
  speed.peak_force_N = compared(
      group.peak_force_N, group, impacts, [](const BallImpact& b) { return b.peak_force_N.sd; },
      foretold.peak_force_N);
  speed.contact_time_s = compared(
      group.contact_time_s, group, impacts, [](const BallImpact& b) { return b.contact_time_s.sd; },
      foretold.contact_time_s);
  speed.impulse_N_s = compared(
      group.impulse_N_s, group, impacts, [](const BallImpact& b) { return b.impulse_N_s.sd; },
      foretold.impulse_N_s);
  speed.restitution_by_speed = compared(
      group.restitution_by_speed, group, impacts,
      [](const BallImpact& b) { return sd_of(b.restitution_by_speed); }, foretold.restitution);
  speed.restitution_by_impulse = compared(
      group.restitution_by_impulse, group, impacts,
      [](const BallImpact& b) { return sd_of(b.restitution_by_impulse); }, foretold.restitution);
}

double force_at(const BallImpact& ball, double time_s) {
  const double interval_s = ball.time_s[1] - ball.time_s[0];
  const double place = (time_s - ball.time_s.front()) / interval_s;
  if (place < 0.0) {
    return std::max(0.0, ball.force_N.front() * time_s / std::max(ball.time_s.front(), 1e-12));
  }
  const auto n = static_cast<std::size_t>(place);
  if (n + 1 >= ball.force_N.size()) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  const double share = place - static_cast<double>(n);
  return (1.0 - share) * ball.force_N[n] + share * ball.force_N[n + 1];
}

void compare_histories(ChainSpeed& speed, const std::vector<BallImpact>& impacts) {
  double squares = 0.0;
  double uncertain = 0.0;
  double count = 0.0;
  const double end_s = speed.foretold.contact_time_s.value;
  for (std::size_t n = 0; n < speed.foretold.time_s.size(); ++n) {
    const double time_s = speed.foretold.time_s[n];
    double mean_N = 0.0;
    for (const std::size_t i : speed.measured.members) {
      mean_N += force_at(impacts[i], time_s) / static_cast<double>(speed.measured.members.size());
    }
    speed.force_N.push_back(mean_N);
    if (std::isfinite(mean_N) && time_s <= end_s) {
      squares += std::pow(mean_N - speed.foretold.force_N[n], 2);
      uncertain += std::pow(speed.foretold.force_sd_N[n], 2);
      ++count;
    }
  }
  const double peak_N = speed.foretold.peak_force_N.value;
  speed.force_rms_share = count > 0.0 ? std::sqrt(squares / count) / peak_N : 0.0;
  speed.force_sd_share = count > 0.0 ? std::sqrt(uncertain / count) / peak_N : 0.0;
}

/// The speed of a group's mean, with its deviation.
Measured speed_of(const BallRepeats& group, const std::vector<BallImpact>& impacts) {
  double own = 0.0;
  for (const std::size_t i : group.members) {
    own = std::max(own, impacts[i].incident_speed_m_per_s->sd);
  }
  return {group.speed_m_per_s.mean, own};
}

Bench ball_bench(const Settings& settings, const std::vector<Shot>& balls) {
  if (settings.bench) {
    Bench bench = read_bench(*settings.bench).bench;
    if (bench.kind != BenchKind::impact) {
      throw InputError(*settings.bench + ": kind", "is not \"impact\"",
                       "give a bench with a [ball]");
    }
    return bench;
  }
  if (balls.empty()) {
    throw InputError(std::string(kPlace) + "--bench", "is missing, and no --ball-shots bring one",
                     "give the impact's bench file, or its captures");
  }
  return balls.front().bench;
}

/// Reduces the balls and sorts them by speed. @throws InputError where none has a speed
std::vector<ForetoldSpeed> measure(const Settings& settings, const std::vector<Shot>& balls,
                                   ChainRun& run) {
  Reducer reducer;
  for (const Shot& shot : balls) {
    const Reduction reduction = reducer.reduce(shot);
    if (!reduction.ball || reduction.quality.verdict() == Verdict::fail) {
      std::string why = reduction.quality.reason;
      for (const Check& check : reduction.quality.checks) {
        why = check.verdict == Verdict::fail ? check.text : why;
      }
      throw InputError(shot.id, "cannot be compared: " + why, "leave it out");
    }
    if (!reduction.ball->incident_speed_m_per_s) {
      throw InputError(shot.id, "has no incident speed",
                       "file incident_speed_m_per_s with the capture, or photo_sensors");
    }
    run.impacts.push_back(*reduction.ball);
  }
  std::vector<ForetoldSpeed> speeds;
  for (BallRepeats& group : group_by_speed(run.impacts)) {
    ForetoldSpeed asked{speed_of(group, run.impacts), std::numeric_limits<double>::infinity(),
                        group.contact_threshold};
    for (const std::size_t i : group.members) {
      asked.low_pass_Hz = std::min(asked.low_pass_Hz, run.impacts[i].low_pass_Hz);
    }
    speeds.push_back(asked);
    run.speeds.push_back({std::move(group), {}, {}, {}, {}, {}, {}, {}, 0.0, 0.0});
  }
  if (settings.speed) {
    speeds.push_back({{*settings.speed, 0.0}, kWithoutMeasurement_Hz, 0.01});
    run.speeds.emplace_back();
  }
  if (speeds.empty()) {
    throw InputError(std::string(kPlace) + "--ball-shots", "is missing, and so is --speed",
                     "give captures of impacts to compare with, or a speed to foretell");
  }
  return speeds;
}

/// What a ball that is foretold as it was measured does not say.
void add_not_constrained(ChainRun& run) {
  double share = 0.0;
  for (const ChainSpeed& speed : run.speeds) {
    share = std::max(share, speed.foretold.strained_share);
  }
  if (share > impact::kStrainedShareToTell) {
    run.remarks.push_back("at the highest speed " + impact::strained_words(share, "the core"));
  }
  run.remarks.emplace_back(
      "an impact holds some two of a material's three numbers: what agrees here says little of "
      "each modulus by itself; kolsky compare says which");
}

void add_remarks(ChainRun& run) {
  double largest = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      largest = std::max(largest, std::abs(run.between[i][j]) /
                                      (run.core.parameters[i].sd * run.cover.parameters[j].sd));
    }
  }
  run.remarks.push_back(
      fmt::format("core and cover are drawn together: what both owe to the same bars correlates "
                  "their numbers by up to {:.2f}",
                  largest));
  run.remarks.emplace_back(
      "the deviations hold if the linear model does: they are no allowance for a wrong one");
  if (!run.impacts.empty()) {
    add_not_constrained(run);
  }
  if (const auto better = run.bar ? better_solid(*run.bar) : std::nullopt) {
    run.remarks.push_back("bar: " + cost_of_going_by(fit_to_file(*run.bar), *better) +
                          "; --bar-solid " + name_of(better->solid) + " goes by it");
  }
  for (const auto& [part, fit] : {std::pair("core", &run.core), std::pair("cover", &run.cover)}) {
    for (const std::string& warning : fit->warnings) {
      run.remarks.push_back(std::string(part) + ": " + warning);
    }
  }
}

int run_command(const Settings& settings, Context& context) {
  ChainRun run;
  run.options = options_of(settings);
  const std::vector<Shot> core = captured_shots(settings.core_shots);
  const std::vector<Shot> cover = captured_shots(settings.cover_shots);
  const std::vector<Shot> balls = captured_shots(settings.ball_shots);
  require_kind(core, BenchKind::shpb, "--core-shots", "shpb");
  require_kind(cover, BenchKind::shpb, "--cover-shots", "shpb");
  require_kind(balls, BenchKind::impact, "--ball-shots", "impact");
  const Bench bench = ball_bench(settings, balls);
  const Material core_filed = filed_material(core, "--core-shots");
  const Material cover_filed = filed_material(cover, "--cover-shots");
  static_cast<void>(impact::check_mass(*bench.ball, core_filed, cover_filed));
  const std::vector<ForetoldSpeed> speeds = measure(settings, balls, run);
  const Bars bars = bars_of(settings, run);
  run.core = fit_of(core, bars, "core");
  run.cover = fit_of(cover, bars, "cover");
  run.between = between(run.core, run.cover, same_bars(core, cover, settings),
                        same_bench(core.front().bench, cover.front().bench));
  SlowWork progress("kolsky chain");
  const std::vector<BallPrediction> predictions = foretell_impacts(
      bench,
      {posterior_of(run.core, core_filed), posterior_of(run.cover, cover_filed), run.between},
      speeds, run.options, all_cores(), [&progress](std::size_t done, std::size_t of) {
        progress.at(fmt::format("{} of {} impacts computed", done, of));
      });
  for (std::size_t i = 0; i < predictions.size(); ++i) {
    run.speeds[i].foretold = predictions[i];
    compare(run.speeds[i], run.impacts);
    if (!run.speeds[i].measured.members.empty()) {
      compare_histories(run.speeds[i], run.impacts);
    }
  }
  add_remarks(run);
  if (settings.svg) {
    write_output(*settings.svg, render_svg(chain_figure(run)));
  }
  context.out << (context.json ? to_text(describe(run)) + "\n" : report(run, context.terminal));
  return kDone;
}

}  // namespace

Command chain_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "chain";
  command.purpose =
      "from bar to specimen to ball: what bar shots foretell of an impact, beside the measured\n"
      "Identifies the bar, then core and cover with the bar's covariance, draws both from what is\n"
      "left open, throws each ball by finite elements at the measured speeds, and prints force,\n"
      "contact time and restitution beside the measured ones with their distance in deviations "
      "(z).";
  command.examples =
      "  kolsky chain --bar-shots bar/*.h5 --core-shots core/*.h5 --cover-shots cover/*.h5 \\\n"
      "      --ball-shots ball/*.h5 --svg chain.svg\n"
      "  kolsky chain --bar-model pmma.toml --core-shots core/ --cover-shots cover/ \\\n"
      "      --bench impact.toml --speed 45 --json > foretold.json\n";
  command.arguments = {
      option("--bar-shots", "CAPTURE",
             "shots on the specimens' bar alone, kind \"bar\"; captures or folders", &s.bar_shots),
      solid_option("--bar-solid",
                   "family of solids that --bar-shots identify: three-element (default), or what "
                   "they\n"
                   "are evidence for (auto)",
                   &s.bar_solid),
      option("--bar-model", "M.toml",
             "what identify bar --model-out wrote, in place of --bar-shots; with neither, elastic "
             "bars, the captures' own bar model or the paper's PMMA",
             &s.bar_model),
      needed("--core-shots", "CAPTURE", "shots on specimens of the core, kind \"shpb\"",
             &s.core_shots),
      needed("--cover-shots", "CAPTURE", "shots on specimens of the cover", &s.cover_shots),
      option("--ball-shots", "CAPTURE",
             "impacts to compare with, kind \"impact\", each with its incident speed",
             &s.ball_shots),
      option("--bench", "B.toml", "the impact's bench; else that of the first of --ball-shots",
             &s.bench),
      option("--speed", "V", "a further speed to foretell, in m/s", &s.speed),
      option("--reading", "READING",
             "the uniaxial law in three dimensions: full (default), bulk-E1, bulk-Einf, exact",
             &s.reading),
      option("--law", "STRESS",
             "what the law gives from Hencky's strain: kirchhoff (default) or cauchy stress, by "
             "which codes differ",
             &s.law),
      option("--friction", "MU", "coefficient between ball and bar, 0.3 unless given", &s.friction),
      option("--draws", "N",
             "balls drawn from the specimens' posterior, at each speed; 32 unless given", &s.draws),
      option("--elements", "N",
             "of the drawn balls, about; 512 unless given. The value itself is from four times as "
             "many",
             &s.elements),
      option("--svg", "FILE", "a page to write: force histories, measured and foretold", &s.svg)};
  command.run = [settings](Context& context) { return run_command(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

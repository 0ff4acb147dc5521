#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/numbers.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/impact_run.hpp"
#include "drivers/files/settings/bench_file.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "drivers/files/settings/toml_table.hpp"
#include "processing/base/error.hpp"
#include "processing/base/range.hpp"

namespace kolsky::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTellEvery_s = 1.0;
constexpr double kLogEvery_s = 15.0;

struct Settings {
  std::string bench;
  std::string core;
  std::string cover;
  std::optional<double> speed;
  std::optional<double> friction;
  std::optional<std::string> target;
  std::optional<std::string> reading;
  std::optional<std::string> law;
  std::optional<std::uint64_t> elements;
  std::optional<double> core_nonlinearity;
  std::optional<double> cover_nonlinearity;
  std::optional<std::string> core_relaxation;
  std::optional<std::string> cover_relaxation;
  std::optional<double> sabot_mass;
  std::optional<double> offset;
  std::optional<double> time_step;
  std::vector<std::string> fields;
  std::vector<std::string> probes;
  std::optional<std::string> svg;
  std::optional<std::string> figures;
};

constexpr const char* kPlace = "kolsky impact: ";

std::pair<double, double> two_numbers_in(const std::string& text, const std::string& option_name,
                                         const std::string& mend) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos) {
    throw InputError(kPlace + option_name, "\"" + text + "\" lacks a comma", mend);
  }
  return {number_in(text.substr(0, comma), kPlace + option_name),
          number_in(text.substr(comma + 1), kPlace + option_name)};
}

// "D,TAU".
impact::KelvinUnit kelvin_unit(const std::optional<std::string>& text,
                               const std::string& option_name) {
  if (!text.has_value()) {
    return {};
  }
  const auto [compliance_per_Pa, time_s] =
      two_numbers_in(*text, option_name, "give compliance and time, as 1e-9,1e-4");
  if (!(compliance_per_Pa >= 0.0) || !(time_s > 0.0)) {
    throw InputError(kPlace + option_name, "\"" + *text + "\" is not a passive solid's",
                     "give a compliance in 1/Pa from 0 up and a time above 0 s, as 1e-9,1e-4");
  }
  return {compliance_per_Pa, time_s};
}

// "R,Z", or the paper's where none is asked for.
std::vector<NamedProbe> probes_of(const std::vector<std::string>& texts) {
  if (texts.empty()) {
    return paper_probes();
  }
  std::vector<NamedProbe> probes;
  for (const std::string& text : texts) {
    const auto [radial_m, axial_m] = two_numbers_in(
        text, "--probe", "give metres from the axis and from the centre, as 0.005,0.01");
    probes.push_back({text, {radial_m, axial_m}});
  }
  return probes;
}

impact::BallMaterial material(const std::string& file, const Settings& settings, bool core) {
  impact::BallMaterial part;
  part.material = read_material(file);
  part.reading =
      impact::reading_named(settings.reading.value_or("full"), std::string(kPlace) + "--reading");
  part.law = impact::finite_strain_named(settings.law.value_or("kirchhoff"),
                                         std::string(kPlace) + "--law");
  part.nonlinearity =
      (core ? settings.core_nonlinearity : settings.cover_nonlinearity).value_or(0.0);
  part.second = core ? kelvin_unit(settings.core_relaxation, "--core-relaxation")
                     : kelvin_unit(settings.cover_relaxation, "--cover-relaxation");
  try {
    static_cast<void>(impact::solid_of(part));
  } catch (const InputError& error) {
    throw TomlTable::open(file).located(error);
  }
  return part;
}

double speed_of(const Settings& settings) {
  if (!settings.speed.has_value()) {
    throw InputError(std::string(kPlace) + "--speed", "is missing",
                     "give the ball's speed in m/s, or --figures for the paper's");
  }
  return *settings.speed;
}

// The figures have speeds, frictions, readings and meshes of their own.
void refuse_beside_figures(const Settings& settings) {
  const std::pair<const char*, bool> options[] = {{"--speed", settings.speed.has_value()},
                                                  {"--friction", settings.friction.has_value()},
                                                  {"--target", settings.target.has_value()},
                                                  {"--reading", settings.reading.has_value()},
                                                  {"--elements", settings.elements.has_value()},
                                                  {"--sabot-mass", settings.sabot_mass.has_value()},
                                                  {"--offset", settings.offset.has_value()},
                                                  {"--time-step", settings.time_step.has_value()},
                                                  {"--field", !settings.fields.empty()},
                                                  {"--probe", !settings.probes.empty()},
                                                  {"--svg", settings.svg.has_value()}};
  for (const auto& [name, given] : options) {
    if (given) {
      throw InputError(std::string(kPlace) + name,
                       "does not go with --figures, which has the paper's speeds, frictions and "
                       "readings on meshes of its own",
                       std::string("leave out ") + name + ", or --figures");
    }
  }
}

// Where the user gave what the simulation names by a member of its model; none where it is no
// member.
std::optional<std::string> place_of(const std::string& member, const Settings& settings) {
  const std::string options = kPlace;
  const std::pair<const char*, std::string> places[] = {
      {"impact", "kolsky impact"},  // the run as a whole
      {"speed_m_per_s", options + "--speed"},
      {"friction", options + "--friction"},
      {"sabot_mass_kg", options + "--sabot-mass"},
      {"offset_m", options + "--offset"},
      {"elements", options + "--elements"},
      {"time_step_s", options + "--time-step"},
      {"layers[0].solid", settings.core_relaxation ? options + "--core-relaxation" : settings.core},
      {"layers[1].solid",
       settings.cover_relaxation ? options + "--cover-relaxation" : settings.cover},
      {"layers[0].solid.nonlinearity", options + "--core-nonlinearity"},
      {"layers[1].solid.nonlinearity", options + "--cover-nonlinearity"},
      {"field_times_s", options + "--field"}};
  for (const auto& [name, place] : places) {
    if (member == name) {
      return place;
    }
  }
  if (member.starts_with("probes[")) {
    return options + "--probe";  // its numbers are in the line
  }
  return std::nullopt;
}

// The bench's key of a member of the model, or the key itself.
std::optional<std::string> bench_key(const std::string& place) {
  const std::pair<const char*, const char*> keys[] = {
      {"layers[0].outer_diameter_m", "ball.core_diameter_m"},
      {"layers[1].outer_diameter_m", "ball.outer_diameter_m"},
      {"target.diameter_m", "bars.input.diameter_m"},
      {"gauge_positions_m", "gauges"}};
  for (const auto& [member, key] : keys) {
    if (place == member) {
      return key;
    }
  }
  return place.starts_with("bars.") || place.starts_with("ball.") ? std::optional(place)
                                                                  : std::nullopt;
}

// An error of the simulation as the user can mend it: an option, a file, a line of the bench.
InputError as_given(const InputError& error, const Settings& settings) {
  if (const auto key = bench_key(error.place())) {
    return TomlTable::open(settings.bench).located({*key, error.problem(), error.mend()});
  }
  return {place_of(error.place(), settings).value_or(error.place()), error.problem(), error.mend()};
}

void prepare(ImpactRun& run, const Settings& settings, bool json) {
  const auto target =
      impact::target_named(settings.target.value_or("dashpot"), std::string(kPlace) + "--target");
  try {
    run.mass =
        impact::check_mass(run.bench.ball.value_or(Ball{}), run.core.material, run.cover.material);
    run.model = impact_on(run.bench, run.core, run.cover, target, speed_of(settings));
  } catch (const InputError& error) {
    throw as_given(error, settings);
  }
  run.model.friction = settings.friction.value_or(run.model.friction);
  run.model.sabot_mass_kg = settings.sabot_mass.value_or(0.0);
  run.model.offset_m = settings.offset.value_or(0.0);
  run.model.time_step_s = settings.time_step.value_or(0.0);
  run.model.elements = settings.elements.value_or(run.model.elements);
  for (const NamedProbe& probe : probes_of(settings.probes)) {
    // The paper's points may lie outside a smaller ball; a point that was asked for is refused.
    if (!settings.probes.empty() || std::hypot(probe.probe.radial_m, probe.probe.axial_m) <
                                        0.5 * run.model.layers.back().outer_diameter_m) {
      run.probe_names.push_back(probe.name);
      run.model.probes.push_back(probe.probe);
    }
  }
  for (const Gauge& gauge : run.bench.gauges) {
    if (target == impact::TargetKind::bar) {
      run.gauge_names.push_back(gauge.name);
      run.model.gauge_positions_m.push_back(gauge.position_m);
    }
  }
  if (!settings.fields.empty() && !settings.svg.has_value() && !json) {
    throw InputError(std::string(kPlace) + "--field", "shows in a picture or in JSON only",
                     "give --svg FILE or --json beside it");
  }
  for (const std::string& time : settings.fields) {
    run.model.field_times_s.push_back(number_in(time, std::string(kPlace) + "--field"));
  }
  run.model.field_at_turn = settings.svg.has_value() && settings.fields.empty();
}

// A line on stderr once a run takes longer than a person likes to wait, and now and then in a log.
class ProgressLine {
 public:
  explicit ProgressLine(Clock::time_point start)
      : last_(start), every_s_(terminal_of(2).interactive ? kTellEvery_s : kLogEvery_s) {}

  void show(const impact::Progress& progress) {
    if (std::chrono::duration<double>(Clock::now() - last_).count() < every_s_) {
      return;
    }
    last_ = Clock::now();
    std::cerr << "kolsky impact: " << std::lround(1e6 * progress.time_s) << " us simulated, "
              << std::lround(progress.force_N) << " N, " << progress.steps << " steps" << std::endl;
  }

 private:
  Clock::time_point last_;
  double every_s_;
};

void simulate(ImpactRun& run, const Settings& settings) {
  const Clock::time_point start = Clock::now();
  ProgressLine line(start);
  try {
    run.history = impact::simulate(
        run.model, [&line](const impact::Progress& progress) { line.show(progress); });
  } catch (const InputError& error) {
    throw as_given(error, settings);
  }
  if (run.history.fields.size() < run.model.field_times_s.size()) {
    throw InputError(std::string(kPlace) + "--field",
                     "a time is after the end, when the ball has left",
                     "give times up to " + in_words(run.history.time_s.back(), "s"));
  }
  run.wall_s = std::chrono::duration<double>(Clock::now() - start).count();
}

int draw_figures(const ImpactRun& run, const Settings& settings, Context& context) {
  std::string text;
  try {
    text = write_paper_figures(run.bench, run.core, run.cover, *settings.figures);
  } catch (const InputError& error) {
    throw as_given(error, settings);
  }
  if (context.json) {
    context.out << to_text(JsonObject{{"folder", *settings.figures}, {"table", text}}) << "\n";
  } else {
    context.out << text;
  }
  return kDone;
}

int run_command(const Settings& settings, Context& context) {
  ImpactRun run;
  run.bench = read_bench(settings.bench).bench;
  if (!run.bench.ball) {
    throw InputError(settings.bench + ": kind", "is not \"impact\"", "give a bench with a [ball]");
  }
  if (settings.figures.has_value()) {
    refuse_beside_figures(settings);
  }
  run.core = material(settings.core, settings, true);
  run.cover = material(settings.cover, settings, false);
  if (settings.figures.has_value()) {
    return draw_figures(run, settings, context);
  }
  prepare(run, settings, context.json);
  simulate(run, settings);
  if (settings.svg.has_value()) {
    write_output(*settings.svg, page(run));
  }
  context.out << (context.json ? to_text(describe(run)) + "\n" : report(run, context.terminal));
  return kDone;
}

}  // namespace

std::vector<NamedProbe> paper_probes() {
  return {{"1 front", {0.0, 0.010}}, {"2 centre", {0.0, 0.0}}, {"3 rear", {0.0, -0.010}}};
}

Command impact_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "impact";
  command.purpose =
      "a layered ball on the end of a bar: force and restitution from material models\n"
      "Axisymmetric, finite deformation, explicit; compression positive, t = 0 at first touch.";
  command.examples =
      "  kolsky impact --bench impact.toml --core core.toml --cover cover.toml --speed 40.3\n"
      "  kolsky impact --bench impact.toml --core core.toml --cover cover.toml --speed 51 \\\n"
      "      --friction 0 --reading bulk-Einf --json > impact.json\n"
      "  kolsky impact --bench impact.toml --core core.toml --cover cover.toml --speed 40.3 \\\n"
      "      --svg ball.svg --field 1e-4 --field 2e-4\n"
      "  kolsky impact --bench impact.toml --core core.toml --cover cover.toml --figures paper/\n";
  command.arguments = {
      needed("--bench", "B.toml", "bench file, kind \"impact\"", &s.bench),
      needed("--core", "C.toml", "material file of the core", &s.core),
      needed("--cover", "V.toml", "material file of the cover", &s.cover),
      option("--speed", "V", "of the ball, in m/s", &s.speed),
      option("--friction", "MU", "coefficient between ball and target, 0.3 unless given",
             &s.friction),
      option("--target", "TARGET",
             "rigid: a plane at rest; dashpot (default): one with the bar's impedance; bar: the "
             "bar meshed, with strain at the bench's gauges",
             &s.target),
      option("--reading", "READING",
             "the uniaxial law in three dimensions: full (default: G and K relax), bulk-E1, "
             "bulk-Einf (K elastic), exact (K elastic, uniaxial law kept)",
             &s.reading),
      option("--law", "STRESS",
             "what the law gives from Hencky's strain: kirchhoff (default) or cauchy stress; at "
             "51 m/s they part by a hundredth of the peak",
             &s.law),
      option("--elements", "N", "of the ball, about; 2048 unless given", &s.elements),
      option("--core-nonlinearity", "B",
             "instantaneous deviatoric stress x (1 + B equivalent strain)", &s.core_nonlinearity),
      option("--cover-nonlinearity", "B", "the same in the cover", &s.cover_nonlinearity),
      option("--core-relaxation", "D,TAU", "a second relaxation: compliance in 1/Pa and time in s",
             &s.core_relaxation),
      option("--cover-relaxation", "D,TAU", "the same in the cover", &s.cover_relaxation),
      option("--sabot-mass", "KG", "a rigid mass that follows and touches the rear pole",
             &s.sabot_mass),
      option("--offset", "M",
             "ball's axis off the bar's, in m: what overhangs yields; an axisymmetric estimate, "
             "good to perhaps a factor of two, without the bar's bending",
             &s.offset),
      option("--time-step", "S", "largest step in s; else what is stable", &s.time_step),
      option("--field", "S",
             "a time at which the picture and --json show the ball; else the picture shows that of "
             "the largest deformation",
             &s.fields),
      option("--probe", "R,Z",
             "a point of the ball whose strain and strain rate are followed, in m from its axis "
             "and from its centre towards the target; else three on the axis",
             &s.probes),
      option("--svg", "FILE", "a page to write: deformed ball with axial stress, and histories",
             &s.svg),
      option("--figures", "FOLDER",
             "the paper's figures 11 to 15 and their tables to write, for the bench's ball and one "
             "with a core of 38 mm; --law, nonlinearities and relaxations go with it",
             &s.figures)};
  command.run = [settings](Context& context) { return run_command(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

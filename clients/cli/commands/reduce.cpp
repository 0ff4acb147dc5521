#include <filesystem>
#include <memory>
#include <ostream>
#include <set>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/threads.hpp"
#include "clients/figure/ball_figure.hpp"
#include "clients/figure/reduction_figure.hpp"
#include "clients/report/svg.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/exports/export.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

constexpr mode_t kReadableByAll = 0644;

struct Settings {
  std::vector<std::string> captures;
  std::optional<std::string> bar_model;
  bool with_true = false;
  std::optional<double> arrival_s;
  std::optional<double> band_limit_Hz;
  std::optional<double> duration_s;
  std::optional<std::string> dispersion;
  std::optional<std::string> separate;
  std::optional<std::string> stress;
  std::optional<std::string> inertia;
  std::optional<double> friction;
  bool uncertainty = false;
  std::optional<std::uint64_t> draws;
  std::optional<double> softening_per_K;
  std::optional<std::string> bench;
  std::optional<std::string> save;
  std::optional<std::string> svg;
  std::optional<std::string> csv;
};

void refuse_not_positive(std::optional<double> number, const std::string& option_name,
                         const std::string& unit) {
  if (number.has_value() && *number <= 0.0) {
    throw InputError("kolsky reduce: " + option_name, "must be above 0 " + unit,
                     "give a positive number in " + unit);
  }
}

Corrections corrections_of(const Settings& settings) {
  Corrections corrections;
  if (settings.inertia.has_value()) {
    const std::string& kind = *settings.inertia;
    if (kind != "axial" && kind != "radial" && kind != "both") {
      throw InputError("kolsky reduce: --inertia", "\"" + kind + "\" is not one",
                       "give axial, radial or both");
    }
    corrections.axial_inertia = kind != "radial";
    corrections.radial_inertia = kind != "axial";
  }
  if (settings.friction.has_value()) {
    if (!(*settings.friction >= 0.0 && *settings.friction <= 1.0)) {
      throw InputError("kolsky reduce: --friction", "is outside 0 to 1",
                       "give the coefficient between specimen and bars, as 0.1");
    }
    corrections.friction = settings.friction;
  }
  return corrections;
}

std::vector<std::string> names_of(const Corrections& corrections) {
  std::vector<std::string> names;
  if (corrections.axial_inertia) {
    names.emplace_back("axial inertia");
  }
  if (corrections.radial_inertia) {
    names.emplace_back("radial inertia");
  }
  if (corrections.friction.has_value()) {
    names.emplace_back("friction");
  }
  return names;
}

ReductionOptions reduction_options(const Settings& settings,
                                   const std::optional<BarModelFile>& bars) {
  ReductionOptions options;
  if (bars.has_value()) {
    options.bar_model = bars->prior.material;
    options.most_band_Hz = bars->band_limit_Hz;
    require_band(*bars, settings.band_limit_Hz);
  }
  if (settings.stress.has_value()) {
    options.stress = stress_from(*settings.stress);
  }
  if (settings.separate.has_value()) {
    options.separation = separation_from(*settings.separate);
  }
  if (settings.softening_per_K.has_value() &&
      !(*settings.softening_per_K >= 0.0 && *settings.softening_per_K < 1.0)) {
    throw InputError("kolsky reduce: --softening", "is outside 0 to 1 per kelvin",
                     "0.003 is usual: polymers soften as they warm");
  }
  options.corrections = corrections_of(settings);
  refuse_not_positive(settings.band_limit_Hz, "--band-limit", "Hz");
  refuse_not_positive(settings.duration_s, "--duration", "s");
  options.duration_s = settings.duration_s;
  if (settings.dispersion.has_value()) {
    options.theory = wave_theory(*settings.dispersion);
  }
  options.arrival_s = settings.arrival_s;
  options.band_limit_Hz = settings.band_limit_Hz;
  return options;
}

UncertaintyOptions uncertainty_options(const Settings& settings,
                                       const std::optional<BarModelFile>& bars) {
  constexpr std::uint64_t kFewest = 20;
  constexpr std::uint64_t kMost = 1'000'000;
  UncertaintyOptions options;
  options.draws = settings.draws.value_or(options.draws);
  if (options.draws < kFewest || options.draws > kMost) {
    throw InputError("kolsky reduce: --draws", "is outside 20 to 1000000",
                     "1000 give the deviations to 2 %");
  }
  if (bars.has_value()) {
    options.bars = bars->prior;
  }
  options.softening_per_K = settings.softening_per_K.value_or(options.softening_per_K);
  return options;
}

void refuse_one_name_for_two(const Settings& settings) {
  std::set<std::filesystem::path> names;
  for (const auto& name : {settings.save, settings.svg, settings.csv}) {
    if (name.has_value() &&
        !names.insert(std::filesystem::weakly_canonical(std::filesystem::absolute(*name))).second) {
      throw InputError(*name, "is to be two files", "give each file to write a name of its own");
    }
  }
}

void write_files(const Settings& settings, const ReducedShot& reduced) {
  if (settings.save.has_value()) {
    Shot corrected = reduced.shot;
    corrected.meta["corrected_from"] = reduced.capture;
    write_capture(corrected, *settings.save);
  }
  if (settings.svg.has_value()) {
    NewFile page(*settings.svg);
    page.write(render_svg(reduced.reduction.ball
                              ? ball_figure(reduced.reduction, reduced.shot.id)
                              : reduction_figure(reduced.reduction, reduced.shot.id)));
    page.publish(kReadableByAll);
  }
  if (settings.csv.has_value()) {
    export_shot(reduced.shot, reduced.reduction, ExportFormat::csv, *settings.csv);
  }
}

// What asks for a specimen means nothing for a ball.
void refuse_for_ball(const Settings& settings) {
  const std::pair<bool, const char*> specimens[] = {
      {settings.bar_model.has_value(), "--bar-model"},
      {settings.with_true, "--true"},
      {settings.separate.has_value(), "--separate"},
      {settings.stress.has_value(), "--stress"},
      {settings.inertia.has_value(), "--inertia"},
      {settings.friction.has_value(), "--friction"},
      {settings.uncertainty, "--uncertainty"},
      {settings.draws.has_value(), "--draws"},
      {settings.softening_per_K.has_value(), "--softening"}};
  for (const auto& [given, name] : specimens) {
    if (given) {
      throw InputError(std::string("kolsky reduce: ") + name,
                       "is for specimens, and this is a ball on an elastic bar",
                       "leave it out; an impact's deviations come by themselves");
    }
  }
}

// Without histories there is nothing to show or to write.
void require_histories(const ReducedShot& reduced) {
  const Quality& quality = reduced.reduction.quality;
  if (!quality.reducible) {
    throw InputError(reduced.capture + ": record", quality.reason, quality.mend);
  }
}

int reduce_several(const Settings& settings, const ReductionOptions& options, Context& context) {
  if (settings.save || settings.svg || settings.csv) {
    throw InputError("kolsky reduce: CAPTURE", "is given more than once beside a file to write",
                     "give one capture for --save, --svg or --csv");
  }
  refuse_for_ball(settings);
  std::vector<ReducedShot> shots;
  for (const std::string& capture : settings.captures) {
    shots.push_back(reduce_capture(capture, options, settings.bench));
    if (shots.back().shot.bench.kind != BenchKind::impact) {
      throw InputError(capture + ": kind", "is not \"impact\": only impacts are reduced together",
                       "reduce specimens one by one, or `kolsky identify specimen` them together");
    }
  }
  context.out << (context.json ? to_text(describe_balls(shots)) + "\n"
                               : balls_report(shots, context.terminal));
  return kDone;
}

int run(const Settings& settings, Context& context) {
  refuse_one_name_for_two(settings);
  std::optional<BarModelFile> bars;
  if (settings.bar_model.has_value()) {
    bars = read_bar_model(*settings.bar_model);
  }
  const ReductionOptions options = reduction_options(settings, bars);
  if (settings.captures.size() > 1) {
    return reduce_several(settings, options, context);
  }
  ReducedShot reduced = reduce_capture(settings.captures.front(), options, settings.bench);
  if (reduced.shot.bench.kind == BenchKind::impact) {
    refuse_for_ball(settings);
  }
  require_histories(reduced);
  if (bars.has_value()) {
    require_holds(*bars, reduced.shot);
    const std::string unchecked = temperature_unchecked(*bars, reduced.shot);
    if (!unchecked.empty()) {
      reduced.reduction.bar_model += " (" + unchecked + ")";
    }
  }
  reduced.stress = settings.stress.value_or(reduced.stress);
  reduced.corrections = names_of(options.corrections);
  if (settings.uncertainty || settings.draws.has_value()) {
    reduced.uncertainty = propagate(reduced.shot, options, reduced.reduction,
                                    uncertainty_options(settings, bars), all_cores());
  }
  write_files(settings, reduced);
  context.out << (context.json ? to_text(describe(reduced, settings.with_true)) + "\n"
                               : report(reduced, context.terminal));
  return kDone;
}

}  // namespace

Command reduce_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "reduce";
  command.purpose =
      "a specimen's stress, strain, strain rate and forces from a capture, or a ball's impact\n"
      "Three-wave analysis with the bars' dispersion; engineering values, compression positive,\n"
      "t = 0 when the pulse arrives at the specimen. Says how far the result can be trusted.\n"
      "Of a bench of kind \"impact\": force on the struck face, peak, contact time, impulse and\n"
      "restitution by speed and by impulse; several captures also give the repeats at each speed.";
  command.examples =
      "  kolsky reduce shot.h5\n"
      "  kolsky reduce shot.h5 --json --true > shot.json\n"
      "  kolsky reduce shot.h5 --bar-model pmma.toml --svg shot.svg --csv shot.csv\n"
      "  kolsky reduce shot.h5 --bar-model pmma.toml --uncertainty\n"
      "  kolsky reduce foam.h5 --separate gauges --duration 3e-3\n"
      "  kolsky reduce shot.h5 --bench corrected.toml --save corrected.h5\n"
      "  kolsky reduce ball1.h5 ball2.h5 ball3.h5\n";
  command.arguments = {
      needed("CAPTURE", "", "the capture to reduce; several of a ball on a bar", &s.captures),
      option("--bar-model", "M.toml",
             "material file of viscoelastic bars; else the capture's own, else the paper's PMMA",
             &s.bar_model),
      flag("--true", kTrueHelp, &s.with_true),
      option("--arrival", "S",
             "foot of the incident pulse at the first gauge, in s from the first sample",
             &s.arrival_s),
      option("--band-limit", "HZ",
             "upper end of the frequencies used, in Hz; else what the noise allows",
             &s.band_limit_Hz),
      option("--duration", "S",
             "length of the histories in s; else until a wave comes back from a bar's far end",
             &s.duration_s),
      option("--dispersion", "THEORY",
             "how waves travel in the bars: elementary (the paper, default), love or exact",
             &s.dispersion),
      option(
          "--separate", "BY",
          "tell waves that overlap apart by gauges (two places on the input bar) or equilibrium\n"
          "(one place and the output bar's force); never: by time; auto (default): by gauges\n"
          "where the striker still pushes when the specimen answers at the gauge, if there are two",
          &s.separate),
      option("--stress", "WAVES",
             "three-wave (mean of both faces, default), one-wave (back) or two-wave (front)",
             &s.stress),
      option("--inertia", "KIND", "take the specimen's inertia off: axial, radial or both",
             &s.inertia),
      option("--friction", "MU", "take friction at the faces off: its coefficient", &s.friction),
      flag("--uncertainty",
           "propagate noise and every <key>_sd of bench and bar model: bands, intervals, budget",
           &s.uncertainty),
      option("--draws", "N", "how many draws the uncertainty is from; 1000 by default", &s.draws),
      option(
          "--softening", "PER_KELVIN",
          "relative loss of viscoelastic bars' moduli per kelvin, for temperature_K_sd; 0.003 by "
          "default",
          &s.softening_per_K),
      option("--bench", "BENCH.toml",
             "a corrected bench file: a new result beside the one with the capture's own",
             &s.bench),
      option("--save", "CAPTURE.h5",
             "a new capture to write: the same samples with the corrected bench", &s.save),
      option("--svg", "FILE", "a page of plots to write", &s.svg),
      option("--csv", "FILE", "a table of the histories to write, with the gauges beside it",
             &s.csv)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

#include <algorithm>
#include <filesystem>
#include <memory>
#include <ostream>
#include <set>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/bar_options.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/doubts.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/threads.hpp"
#include "clients/figure/ball_figure.hpp"
#include "clients/figure/reduction_figure.hpp"
#include "clients/report/svg.hpp"
#include "drivers/files/captures/capture.hpp"
#include "drivers/files/exports/export.hpp"
#include "processing/base/error.hpp"
#include "processing/reduction/requested.hpp"

namespace kolsky::cli {
namespace {

constexpr const char* kName = "kolsky reduce";

struct Settings {
  std::vector<std::string> captures;
  std::optional<std::string> bar_model;
  ReductionRequest request;
  bool defaults = false;
  std::optional<double> arrival_s;
  bool uncertainty = false;
  std::optional<std::uint64_t> draws;
  std::optional<double> softening_per_K;
  std::optional<std::string> bench;
  std::optional<std::string> save;
  std::optional<std::string> svg;
  std::optional<std::string> csv;
};

/// By which option a request's key is given: band_limit_Hz by --band-limit.
std::string option_of(const std::string& key) {
  std::string name = key.substr(0, key.find(key.ends_with("_Hz") ? "_Hz" : "_s"));
  std::ranges::replace(name, '_', '-');
  return "--" + name;
}

/// Runs a check of the request; what it refuses is named as the user gave it.
template <class Check>
void as_given(const Check& check) {
  try {
    check();
  } catch (const InputError& error) {
    throw InputError("kolsky reduce: " + option_of(error.place()), error.problem(), error.mend());
  }
}

Asked asked_by(const Settings& settings, const std::optional<BarModelFile>& bars) {
  as_given([&] { static_cast<void>(options_of(settings.request)); });
  Asked asked;
  asked.request = settings.request;
  asked.as_filed = !settings.defaults;
  asked.arrival_s = settings.arrival_s;
  asked.bench = settings.bench;
  if (bars.has_value()) {
    asked.bar_model = bars->prior.material;
    require_band(*bars, settings.request.band_limit_Hz);
  }
  if (settings.draws) {
    require_draws(kName, *settings.draws);
  }
  if (settings.softening_per_K) {
    require_softening(kName, *settings.softening_per_K);
    if (!settings.uncertainty && !settings.draws) {
      throw InputError(std::string(kName) + ": --softening",
                       "counts with --uncertainty only, which is not asked for",
                       "give --uncertainty beside it, or leave it out");
    }
  }
  return asked;
}

UncertaintyOptions uncertainty_options(const Settings& settings,
                                       const std::optional<BarModelFile>& bars, const Shot& shot) {
  UncertaintyOptions options;
  options.draws = settings.draws.value_or(options.draws);
  options.bars = bars ? bars->prior : BarPrior(shot.bar_model.value_or(paper_pmma()));
  options.bars->softening_per_K = settings.softening_per_K.value_or(options.bars->softening_per_K);
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
    write_output(
        *settings.svg,
        render_svg(reduced.reduction.ball ? ball_figure(reduced.reduction, reduced.shot.id)
                                          : reduction_figure(reduced.reduction, reduced.shot.id)));
  }
  if (settings.csv.has_value()) {
    export_shot(reduced.shot, reduced.reduction, ExportFormat::csv, *settings.csv);
  }
}

// It would be the same capture again.
void refuse_to_save_the_same(const Settings& settings) {
  if (settings.save && !settings.bench) {
    throw InputError(std::string(kName) + ": --save",
                     "writes the samples with a corrected bench, and none is given",
                     "give --bench beside it, or leave it out");
  }
}

// What asks for a specimen means nothing for a ball.
void refuse_for_ball(const Settings& settings, const Shot& ball) {
  as_given([&] { require_suits(settings.request, ball.bench, {}); });
  const std::pair<bool, const char*> specimens[] = {
      {settings.bar_model.has_value(), "--bar-model"},
      {settings.uncertainty, "--uncertainty"},
      {settings.draws.has_value(), "--draws"},
      {settings.softening_per_K.has_value(), "--softening"}};
  for (const auto& [given, name] : specimens) {
    if (given) {
      throw InputError(std::string("kolsky reduce: ") + name, kForSpecimens, kLeaveOutForBall);
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

int reduce_several(const Settings& settings, const Asked& asked, Context& context) {
  if (settings.save || settings.svg || settings.csv) {
    throw InputError("kolsky reduce: CAPTURE", "is given more than once beside a file to write",
                     "give one capture for --save, --svg or --csv");
  }
  std::vector<ReducedShot> shots;
  for (const std::string& capture : settings.captures) {
    shots.push_back(reduce_capture(capture, asked));
    if (shots.back().shot.bench.kind != BenchKind::impact) {
      throw InputError(capture + ": kind", "is not \"impact\": only impacts are reduced together",
                       "reduce specimens one by one, or `kolsky identify specimen` them together");
    }
    refuse_for_ball(settings, shots.back().shot);
  }
  context.out << (context.json ? to_text(describe_balls(shots)) + "\n"
                               : balls_report(shots, context.terminal));
  return kDone;
}

int run(const Settings& settings, Context& context) {
  refuse_one_name_for_two(settings);
  refuse_to_save_the_same(settings);
  std::optional<BarModelFile> bars;
  if (settings.bar_model.has_value()) {
    bars = read_bar_model(*settings.bar_model);
  }
  const Asked asked = asked_by(settings, bars);
  if (settings.captures.size() > 1) {
    return reduce_several(settings, asked, context);
  }
  ReducedShot reduced = reduce_capture(settings.captures.front(), asked);
  if (reduced.shot.bench.kind == BenchKind::impact) {
    refuse_for_ball(settings, reduced.shot);
  }
  require_histories(reduced);
  if (bars.has_value()) {
    require_holds(*bars, reduced.shot);
    reduced.reduction.bar_model += doubts_in_brackets(bars->prior.material, reduced.shot);
  }
  if (settings.uncertainty || settings.draws.has_value()) {
    reduced.uncertainty = propagate(reduced.shot, reduced.options, reduced.reduction,
                                    uncertainty_options(settings, bars, reduced.shot), all_cores());
  }
  write_files(settings, reduced);
  context.out << (context.json ? to_text(describe(reduced)) + "\n"
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
      flag("--true", kTrueHelp, &s.request.with_true),
      option(
          "--arrival", "S",
          "foot of the incident pulse at the input bar's first gauge, in s from the first sample;\n"
          "the arrival that is printed is at the specimen, later by the way there",
          &s.arrival_s),
      option("--band-limit", "HZ",
             "upper end of the frequencies used, in Hz; else what the noise allows",
             &s.request.band_limit_Hz),
      option("--duration", "S",
             "length of the histories in s; else until a wave comes back from a bar's far end",
             &s.request.duration_s),
      dispersion_option(
          "how waves travel in the bars: elementary (the paper, default), love or exact",
          &s.request.dispersion),
      option(
          "--separate", "BY",
          "tell waves that overlap apart by gauges (two places on the input bar) or equilibrium\n"
          "(one place and the output bar's force); never: by time; auto (default): by gauges\n"
          "where the striker still pushes when the specimen answers at the gauge, if there are two",
          &s.request.separate),
      option("--stress", "WAVES",
             "three-wave (mean of both faces, default), one-wave (back) or two-wave (front)",
             &s.request.stress),
      option("--inertia", "KIND",
             "take the specimen's inertia off: axial, radial or both; none (default)",
             &s.request.inertia),
      option("--friction", "MU", "take friction at the faces off: its coefficient",
             &s.request.friction),
      flag("--defaults",
           "leave aside what a daemon's [reduction] filed with the capture, which else holds\n"
           "where no option says otherwise",
           &s.defaults),
      flag("--uncertainty",
           "propagate noise and every <key>_sd of bench and bar model: bands, intervals, budget",
           &s.uncertainty),
      option("--draws", "N", "how many draws the uncertainty is from; 1000 by default", &s.draws),
      option("--softening", "PER_KELVIN", kSofteningHelp, &s.softening_per_K),
      option("--bench", "BENCH.toml",
             "a corrected bench file: a new result beside the one with the capture's own",
             &s.bench),
      option("--save", "CAPTURE.h5",
             "a new capture to write: the same samples with the bench of --bench", &s.save),
      option("--svg", "FILE", "a page of plots to write", &s.svg),
      option("--csv", "FILE", "a table of the histories to write, with the gauges beside it",
             &s.csv)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

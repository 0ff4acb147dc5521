#include <memory>
#include <ostream>

#include "clients/cli/command.hpp"
#include "clients/cli/reduced_shot.hpp"
#include "clients/figure/reduction_figure.hpp"
#include "clients/report/svg.hpp"
#include "drivers/files/export.hpp"
#include "drivers/files/material_file.hpp"
#include "drivers/files/new_file.hpp"
#include "processing/base/error.hpp"

namespace kolsky::cli {
namespace {

constexpr mode_t kReadableByAll = 0644;

struct Settings {
  std::string capture;
  std::optional<std::string> bar_model;
  bool with_true = false;
  std::optional<double> arrival_s;
  std::optional<double> band_limit_Hz;
  std::optional<double> duration_s;
  std::optional<std::string> dispersion;
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

ReductionOptions reduction_options(const Settings& settings) {
  ReductionOptions options;
  if (settings.bar_model.has_value()) {
    options.bar_model = read_material(*settings.bar_model);
  }
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

void write_files(const Settings& settings, const ReducedShot& reduced) {
  if (settings.svg.has_value()) {
    NewFile page(*settings.svg);
    page.write(render_svg(reduction_figure(reduced.reduction, reduced.shot.id)));
    page.publish(kReadableByAll);
  }
  if (settings.csv.has_value()) {
    export_shot(reduced.shot, reduced.reduction, ExportFormat::csv, *settings.csv);
  }
}

int run(const Settings& settings, Context& context) {
  const ReducedShot reduced = reduce_capture(settings.capture, reduction_options(settings));
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
      "a specimen's stress, strain, strain rate and forces from a capture\n"
      "Three-wave analysis with the bars' dispersion; engineering values, compression positive,\n"
      "t = 0 when the pulse arrives at the specimen. Says how far the result can be trusted.";
  command.examples =
      "  kolsky reduce shot.h5\n"
      "  kolsky reduce shot.h5 --json --true > shot.json\n"
      "  kolsky reduce shot.h5 --bar-model pmma.toml --svg shot.svg --csv shot.csv\n";
  command.arguments = {
      needed("CAPTURE", "", "the capture to reduce", &s.capture),
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
      option("--svg", "FILE", "a page of plots to write", &s.svg),
      option("--csv", "FILE", "a table of the histories to write, with the gauges beside it",
             &s.csv)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

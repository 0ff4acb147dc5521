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
  std::optional<std::string> svg;
  std::optional<std::string> csv;
};

ReductionOptions reduction_options(const Settings& settings) {
  ReductionOptions options;
  if (settings.bar_model.has_value()) {
    options.bar_model = read_material(*settings.bar_model);
  }
  if (settings.band_limit_Hz.has_value() && *settings.band_limit_Hz <= 0.0) {
    throw InputError("kolsky reduce: --band-limit", "must be above 0 Hz", "give a frequency in Hz");
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
  return {
      "reduce",
      "a specimen's stress, strain, strain rate and forces from a capture\n"
      "Three-wave analysis with the bars' dispersion; engineering values, compression positive,\n"
      "t = 0 when the pulse arrives at the specimen. Says how far the result can be trusted.",
      "  kolsky reduce shot.h5\n"
      "  kolsky reduce shot.h5 --json --true > shot.json\n"
      "  kolsky reduce shot.h5 --bar-model pmma.toml --svg shot.svg --csv shot.csv\n",
      false,
      {{"CAPTURE", "CAPTURE.h5", "the capture to reduce", &settings->capture, true, {}},
       {"--bar-model",
        "M.toml",
        "material file of viscoelastic bars; else the capture's own, else the paper's PMMA",
        &settings->bar_model,
        false,
        {}},
       {"--true",
        "",
        "in --json also strain_true = -ln(1 - strain) and stress_true_Pa = stress_Pa (1 - strain), "
        "for a specimen that keeps its volume",
        &settings->with_true,
        false,
        {}},
       {"--arrival",
        "S",
        "foot of the incident pulse at the first gauge, in s from the first sample",
        &settings->arrival_s,
        false,
        {}},
       {"--band-limit",
        "HZ",
        "upper end of the frequencies used, in Hz; else what the noise allows",
        &settings->band_limit_Hz,
        false,
        {}},
       {"--svg", "FILE", "a page of plots to write", &settings->svg, false, {}},
       {"--csv",
        "FILE",
        "a table of the histories to write, with the gauges beside it",
        &settings->csv,
        false,
        {}}},
      [settings](Context& context) { return run(*settings, context); }};
}

}  // namespace kolsky::cli

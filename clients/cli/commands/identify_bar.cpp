#include <memory>
#include <ostream>

#include "clients/cli/bar_options.hpp"
#include "clients/cli/captures.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/doubts.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/bar_report.hpp"
#include "clients/cli/reports/fit_draws.hpp"
#include "clients/cli/slow_work.hpp"
#include "clients/cli/threads.hpp"
#include "clients/report/svg.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/better_solid.hpp"

namespace kolsky::cli {
namespace {

constexpr const char* kName = "kolsky identify bar";

struct Settings {
  std::vector<std::string> captures;
  std::optional<std::string> model_out;
  std::optional<std::string> solid;
  std::optional<std::string> dispersion;
  std::optional<std::string> far_end;
  std::optional<double> band_limit_Hz;
  std::optional<std::string> svg;
  bool waveforms = false;
  std::optional<std::uint64_t> draws;
};

BarIdentificationOptions options_from(const Settings& settings) {
  BarIdentificationOptions options;
  if (settings.dispersion && *settings.dispersion != "auto") {
    options.theory = wave_theory(*settings.dispersion);
  }
  options.solid = solid_asked(settings.solid);
  if (settings.far_end && *settings.far_end != "auto") {
    options.far_end = *settings.far_end == "free"   ? FarEndReturn::free
                      : *settings.far_end == "none" ? FarEndReturn::none
                                                    : FarEndReturn::partial;
  }
  if (settings.band_limit_Hz) {
    if (!(*settings.band_limit_Hz > 0.0)) {
      throw InputError(std::string(kName) + ": --band-limit", "must be above 0 Hz",
                       "give a positive number in Hz");
    }
    options.band_limit_Hz = *settings.band_limit_Hz;
  }
  return options;
}

/// Of a fit without a number that a file takes.
const char* mend_of(SolidKind solid) {
  return solid == SolidKind::three_element
             ? "file an elastic bar by bars.*.youngs_modulus_Pa in the bench instead"
             : "give a --solid of fewer parameters, or auto";
}

void write_material(const std::string& path, const BarIdentification& result,
                    const std::vector<Shot>& shots) {
  const BarFit& fit = fit_to_file(result);
  const bool grows = result.spectrum.mean_loss.gains();
  const Material material =
      material_to_file(result, shots.front().bench.input,
                       "kolsky identify bar, " + std::to_string(shots.size()) + " shots");
  try {
    check(material);
  } catch (const InputError& error) {
    throw InputError(std::string(kName) + ": --model-out",
                     "cannot file this fit: " + error.place() + " " + error.problem(),
                     grows ? "check the gauge factors and the order of the gauges: the waves grow "
                             "on their way"
                           : mend_of(fit.solid));
  }
  const auto better = better_solid(result);
  write_output(
      path, format_material(material, {shots.size(), name_of(fit.theory), fit.chi2_reduced, !grows,
                                       better ? cost_of_filing(fit, *better) : ""}));
}

std::optional<FitDraws> drawn(const std::vector<Shot>& shots, const BarIdentification& result,
                              const Settings& settings) {
  if (!settings.draws) {
    return std::nullopt;
  }
  SlowWork progress(kName);
  return draw_bar_fits(shots, result.three_element, draw_options(*settings.draws, progress),
                       all_cores());
}

BarIdentification identify(const std::vector<Shot>& shots, const Settings& settings) {
  const BarIdentificationOptions options = options_from(settings);
  try {
    return identify_bar(shots, options, all_cores());
  } catch (const InputError& error) {
    throw in_captures(error, settings.captures);
  }
}

int run(const Settings& settings, Context& context) {
  if (settings.draws) {
    require_draws(kName, *settings.draws);
  }
  require_new_output(settings.model_out);
  require_new_output(settings.svg);
  const std::vector<Shot> shots = captured_shots(settings.captures);
  BarIdentification result = identify(shots, settings);
  // Three elements are what there is by default, too.
  result.solid.asked = settings.solid.has_value() && *settings.solid != "auto";
  std::vector<ForetoldShot> foretold;
  if (settings.waveforms || settings.svg) {
    foretold = foretell(shots, result.fit);
  }
  const std::optional<FitDraws> draws = drawn(shots, result, settings);
  // First what was found: a file that cannot be made takes none of it away.
  const std::vector<ForetoldShot> told =
      settings.waveforms ? foretold : std::vector<ForetoldShot>{};
  context.out << (context.json ? to_text(describe(result, told, draws)) + "\n"
                               : report(result, draws));
  if (settings.svg) {
    write_output(*settings.svg, render_svg(bar_figure(result, foretold.front())));
  }
  if (settings.model_out) {
    write_material(*settings.model_out, result, shots);
  }
  return kDone;
}

}  // namespace

Command identify_bar_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "identify bar";
  command.purpose =
      "what a bar is made of, from shots on it alone: moduli, J, attenuation, with deviations\n"
      "Whole records of two or more gauges, whatever the striker did; overlapping waves serve "
      "too.\n"
      "One gauge alone: the pulse and its return from a free far end, over before that arrives.\n"
      "Wave theory and far end are chosen by the records; every alternative is listed.";
  command.examples =
      "  kolsky identify bar shot1.h5 shot2.h5 --model-out pmma.toml\n"
      "  kolsky identify bar shots/ --solid auto --model-out pmma.toml\n"
      "  kolsky identify bar shots/ --json > bar.json\n"
      "  kolsky identify bar shots/ --draws 500\n"
      "  kolsky identify bar shot.h5 --dispersion elementary --svg bar.svg\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of shots on one bar, or folders of them", &s.captures),
      option(
          "--model-out", "M.toml",
          "material file to write, for --bar-model: values, deviations, covariance of the solid\n"
          "that --solid asks for or chooses",
          &s.model_out),
      solid_option(
          "--solid",
          "family of solids for the spectrum and the file: three-element (default), or what the "
          "records\n"
          "are evidence for (auto); the three-element parameters always come too",
          &s.solid),
      dispersion_option(
          "how waves travel in the bar; auto (default): what the records are evidence for",
          &s.dispersion, "auto"),
      Argument{"--far-end",
               "RETURN",
               "what comes back from the far end; auto (default): what the records show",
               &s.far_end,
               false,
               {"free", "none", "partial", "auto"}},
      option("--band-limit", "HZ", "upper end of the frequencies used; else what the noise allows",
             &s.band_limit_Hz),
      flag("--waveforms",
           "in --json also what the first gauge foretells for the others, and what is left",
           &s.waveforms),
      option("--draws", "N", kDrawsHelp, &s.draws),
      option("--svg", "FILE", "a page of plots to write", &s.svg)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

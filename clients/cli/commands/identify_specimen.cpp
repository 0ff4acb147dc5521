#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <ostream>
#include <utility>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/bar_options.hpp"
#include "clients/cli/captures.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/doubts.hpp"
#include "clients/cli/outputs.hpp"
#include "clients/cli/reports/fit_draws.hpp"
#include "clients/cli/reports/specimen_report.hpp"
#include "clients/cli/slow_work.hpp"
#include "clients/cli/threads.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/records/campaign.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/gauge_order.hpp"
#include "processing/reduction/gauge_sign.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/specimen/shpb_records.hpp"

namespace kolsky::cli {
namespace {

constexpr mode_t kReadableByAll = 0644;
constexpr const char* kName = "kolsky identify specimen";

struct Settings {
  std::vector<std::string> captures;
  std::optional<std::string> bar_model;
  std::optional<std::string> model_out;
  std::optional<std::string> solid;
  std::optional<std::string> dispersion;
  std::optional<std::string> specimen;
  std::optional<double> band_limit_Hz;
  std::optional<double> window_s;
  std::optional<std::uint64_t> draws;
  std::optional<double> softening_per_K;
};

void refuse_not_positive(std::optional<double> number, const std::string& name,
                         const std::string& unit) {
  if (number && *number <= 0.0) {
    throw InputError(std::string(kName) + ": " + name, "must be above 0 " + unit,
                     "give a positive number in " + unit);
  }
}

SpecimenFitOptions fit_options(const Settings& settings, const std::optional<BarModelFile>& bars) {
  refuse_not_positive(settings.band_limit_Hz, "--band-limit", "Hz");
  refuse_not_positive(settings.window_s, "--window", "s");
  if (settings.draws) {
    require_draws(kName, *settings.draws);
  }
  if (settings.softening_per_K) {
    require_softening(kName, *settings.softening_per_K);
  }
  SpecimenFitOptions options;
  if (settings.solid) {
    options.solid = solid_kind(*settings.solid);
  }
  if (settings.dispersion) {
    options.bars = wave_theory(*settings.dispersion);
  }
  if (settings.specimen) {
    options.specimen = specimen_waves(*settings.specimen);
  }
  options.band_limit_Hz = settings.band_limit_Hz.value_or(0.0);
  options.most_band_Hz = bars ? bars->band_limit_Hz : std::nullopt;
  options.after_foot_s = settings.window_s;
  return options;
}

/// What a material file holds besides the moduli comes from the bench.
void require_fileable(const Shot& shot) {
  const Specimen& specimen = *shot.bench.specimen;
  if (!specimen.density_kg_m3 || !specimen.poisson_ratio) {
    throw InputError(std::string(kName) + ": --model-out",
                     "needs the specimen's density and Poisson's ratio, which the bench of " +
                         shot.id + " lacks",
                     "file specimen.density_kg_m3 and specimen.poisson_ratio");
  }
}

std::vector<Shot> read_shots(const Settings& settings, const std::optional<BarModelFile>& bars) {
  std::vector<Shot> shots = captured_shots(settings.captures);
  for (const Shot& shot : shots) {
    require_specimen(shot);
    require_own_material_holds(shot);
    require_own_band_known(shot.bench, settings.band_limit_Hz);
    if (settings.model_out) {
      require_fileable(shot);
    }
    if (bars) {
      require_holds(*bars, shot);
    } else if (shot.bar_model) {
      require_bar_model_holds(*shot.bar_model, shot, "the capture's bar model");
    }
  }
  return shots;
}

FitDraws draw(const IdentifiedSpecimen& outcome, const BarPrior& bars, std::uint64_t draws) {
  SlowWork progress(kName);
  return draw_specimen_fits(outcome.shots, bars, outcome.fit,
                            outcome.spectral ? &*outcome.spectral : nullptr,
                            draw_options(draws, progress), all_cores());
}

BarPrior bars_of(const IdentifiedSpecimen& outcome, const Settings& settings) {
  const Shot& first = outcome.shots.front();
  if (outcome.bars) {
    return outcome.bars->prior;
  }
  try {
    return BarPrior(first.bar_model ? *first.bar_model : assumed_bars(first.bench));
  } catch (const InputError& error) {
    throw in_captures(error, settings.captures);
  }
}

/// Whether pulses stand far out at every gauge: a hidden one's inverted return is found first.
bool shows_all_pulses(const Shot& shot) {
  for (std::size_t i = 0; i < shot.bench.gauges.size(); ++i) {
    const std::vector<double> strain = strain_of_gauge(shot, i);
    const auto pulse = first_pulse(strain, shot.rate.Hz());
    if (!pulse || !stands_far_out(strain, *pulse)) {
      return false;
    }
  }
  return true;
}

/// What every shot says against the bench's gauges; empty where they read as filed.
std::string misread_by(const std::vector<Shot>& shots) {
  const auto said = [&](const auto& check_of) {
    std::string text;
    for (const Shot& shot : shots) {
      const std::optional<Check> check = check_of(shot);
      if (!check || check->verdict != Verdict::fail) {
        return std::string();
      }
      text = check->text;
    }
    return text;
  };
  const std::string sign = said(gauge_sign);
  return sign.empty() ? said(gauge_order) : sign;
}

/// Gauges at which no shot shows a pulse.
std::string silent_in(const std::vector<Shot>& shots) {
  std::string names;
  const std::vector<Gauge>& gauges = shots.front().bench.gauges;
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    if (std::ranges::none_of(shots, [i](const Shot& shot) { return holds_pulse(shot, i); })) {
      names += (names.empty() ? "" : ", ") + gauges[i].name;
    }
  }
  return names.empty() ? names : "no pulse stands out of the noise at " + names;
}

/// What a fit makes of gauges that read nothing, or not as filed, is no specimen.
void require_gauges_as_filed(const std::vector<Shot>& shots,
                             const std::vector<std::string>& captures) {
  std::string problem =
      std::ranges::any_of(shots, shows_all_pulses) ? misread_by(shots) : std::string();
  if (problem.empty()) {
    problem = silent_in(shots);
  }
  if (!problem.empty()) {
    throw in_captures({"gauges", problem, "correct the bench file, or check cables and channels"},
                      captures);
  }
}

/// A fit that found nothing, with what the histories say of why.
InputError with_cause(const InputError& error, const std::vector<Shot>& shots, const Material& bars,
                      const SpecimenFitOptions& options) {
  std::string cause;
  SpectralOptions spectral;
  spectral.bars = options.bars.value_or(spectral.bars);
  try {
    cause = gives_energy_back(estimate_spectrum(shots, bars, spectral).spectrum);
  } catch (const InputError&) {
    return error;
  }
  return cause.empty() ? error
                       : InputError(error.place(), error.problem() + ": " + cause,
                                    "check the bar model first, then gauge factors and positions");
}

IdentifiedSpecimen identify(const Settings& settings) {
  IdentifiedSpecimen outcome;
  require_new_output(settings.model_out);
  if (settings.bar_model) {
    outcome.bars = read_bar_model(*settings.bar_model);
    require_band(*outcome.bars, settings.band_limit_Hz);
  }
  SpecimenFitOptions options = fit_options(settings, outcome.bars);
  outcome.shots = read_shots(settings, outcome.bars);
  BarPrior prior = bars_of(outcome, settings);
  options.most_band_Hz = known_band_Hz(outcome.shots.front().bench, prior.material);
  prior.softening_per_K = settings.softening_per_K.value_or(prior.softening_per_K);
  require_band_known(prior.material, settings.band_limit_Hz, "the capture's bar model");
  require_gauges_as_filed(outcome.shots, settings.captures);
  try {
    outcome.fit = fit_specimen(outcome.shots, prior, options);
  } catch (const InputError& error) {
    throw in_captures(with_cause(error, outcome.shots, prior.material, options), settings.captures);
  }
  if (outcome.bars) {
    for (const std::string& doubt :
         doubts_of(outcome.bars->prior.material, outcome.shots.front())) {
      outcome.fit.warnings.push_back("the bar model was " + doubt);
    }
  }
  SpectralOptions spectral;
  spectral.bars = outcome.fit.theory.bars;
  try {
    outcome.spectral = estimate_spectrum(outcome.shots, prior.material, spectral);
    take_in_noise(outcome.shots, prior.material, spectral.bars, *outcome.spectral, all_cores());
    for (std::string& warning : contradiction(outcome.fit, outcome.spectral->parameters)) {
      outcome.spectral->warnings.push_back(std::move(warning));
    }
  } catch (const InputError& error) {
    outcome.spectral_refused = error.what();
  }
  if (settings.draws) {
    outcome.draws = draw(outcome, prior, *settings.draws);
  }
  return outcome;
}

void write_material(const IdentifiedSpecimen& outcome, const std::string& path) {
  const SpecimenFit& fit = outcome.fit;
  const Bench& bench = outcome.shots.front().bench;
  Material material;
  material.density_kg_m3 = *bench.specimen->density_kg_m3;
  material.poisson_ratio = *bench.specimen->poisson_ratio;
  material.solid = fit.solid;
  material.parameters = measured_of(fit.parameters);
  material.source = fmt::format("kolsky identify specimen, {} shots", outcome.shots.size());
  material.covariance = row_by_row(fit.covariance);
  material.identified =
      Material::Identified{fit.band_limit_Hz, temperature_of(outcome.shots.front())};
  try {
    check(material);
  } catch (const InputError& error) {
    throw InputError(std::string(kName) + ": --model-out",
                     "cannot file this fit: " + error.place() + " " + error.problem(),
                     fit.solid == SolidKind::three_element
                         ? "give more shots or a wider band"
                         : "give more shots, a wider band or a --solid of fewer parameters");
  }
  NewFile file(path);
  Identified identified;
  identified.shots = outcome.shots.size();
  identified.dispersion = name_of(fit.theory.bars);
  identified.chi2_reduced = fit.chi2_reduced;
  file.write(format_material(material, identified));
  file.publish(kReadableByAll);
}

int run(const Settings& settings, Context& context) {
  const IdentifiedSpecimen outcome = identify(settings);
  // First what was found: a file that cannot be made takes none of it away.
  context.out << (context.json ? to_text(describe(outcome)) + "\n" : report(outcome));
  if (settings.model_out) {
    write_material(outcome, *settings.model_out);
  }
  return kDone;
}

}  // namespace

Command identify_specimen_command() {
  auto settings = std::make_shared<Settings>();
  Settings& s = *settings;
  Command command;
  command.name = "identify specimen";
  command.purpose =
      "a specimen's complex compliance and a solid that has it, from all shots at once\n"
      "Fits the gauge records themselves, sources free, with what is not known of bench and bars;\n"
      "beside it strain over stress of the reduced histories, mean and scatter over the shots.";
  command.examples =
      "  kolsky identify specimen shot*.h5 --bar-model pmma.toml\n"
      "  kolsky identify specimen shot*.h5 --bar-model pmma.toml --model-out core.toml --json\n"
      "  kolsky identify specimen shot*.h5 --bar-model pmma.toml --draws 500\n"
      "  kolsky identify specimen shot*.h5 --solid two-kelvin --model-out core.toml\n"
      "  kolsky identify specimen shot*.h5 --solid fractional --dispersion exact\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of one bench and material", &s.captures),
      option("--bar-model", "M.toml",
             "material file of viscoelastic bars; its deviations count. Else the capture's own, "
             "else the paper's PMMA",
             &s.bar_model),
      option("--model-out", "S.toml",
             "material file of the solid fitted to write: values, deviations, covariance",
             &s.model_out),
      option(
          "--solid", "FAMILY",
          "three-element (default), four-element-fluid, two-, three- or four-kelvin, or fractional",
          &s.solid),
      dispersion_option(
          "how waves travel in the bars: elementary, love or exact; else what the data say",
          &s.dispersion),
      option("--specimen", "WAVES",
             "massless (the paper), rod (its mass) or lateral (in both directions); else what the "
             "data say",
             &s.specimen),
      option("--band-limit", "HZ", "upper end of the frequencies used; else what the noise allows",
             &s.band_limit_Hz),
      option("--window", "S",
             "time judged after the pulse's foot at the first gauge; else as long as one model "
             "holds",
             &s.window_s),
      option("--draws", "N", kDrawsHelp, &s.draws),
      option("--softening", "PER_KELVIN", kSofteningHelp, &s.softening_per_K)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

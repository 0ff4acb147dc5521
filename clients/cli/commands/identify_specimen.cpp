#include <fmt/format.h>

#include <complex>
#include <memory>
#include <numbers>
#include <ostream>
#include <utility>

#include "clients/cli/bar_model_file.hpp"
#include "clients/cli/captures.hpp"
#include "clients/cli/command.hpp"
#include "clients/cli/reports/budget.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/figure/layout.hpp"
#include "drivers/files/captures/new_file.hpp"
#include "drivers/files/settings/material_file.hpp"
#include "processing/base/bar_model_check.hpp"
#include "processing/base/error.hpp"
#include "processing/identification/parameter_budget.hpp"
#include "processing/specimen/fit_warnings.hpp"
#include "processing/specimen/shpb_records.hpp"
#include "processing/specimen/specimen_fit.hpp"
#include "processing/specimen/specimen_spectrum.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky::cli {
namespace {

constexpr mode_t kReadableByAll = 0644;

struct Settings {
  std::vector<std::string> captures;
  std::optional<std::string> bar_model;
  std::optional<std::string> model_out;
  std::optional<std::string> solid;
  std::optional<std::string> dispersion;
  std::optional<std::string> specimen;
  std::optional<double> band_limit_Hz;
  std::optional<double> window_s;
};

/// What was asked, done, and with which bars.
struct Outcome {
  std::vector<Shot> shots;
  std::optional<BarModelFile> bars;
  SpecimenFit fit;
  std::optional<SpectralEstimate> spectral;
  std::string spectral_refused;  ///< why there is none
};

void refuse_not_positive(std::optional<double> number, const std::string& name,
                         const std::string& unit) {
  if (number && *number <= 0.0) {
    throw InputError("kolsky identify specimen: " + name, "must be above 0 " + unit,
                     "give a positive number in " + unit);
  }
}

SpecimenFitOptions fit_options(const Settings& settings, const std::optional<BarModelFile>& bars) {
  refuse_not_positive(settings.band_limit_Hz, "--band-limit", "Hz");
  refuse_not_positive(settings.window_s, "--window", "s");
  SpecimenFitOptions options;
  if (settings.solid) {
    options.solid = solid_kind(*settings.solid);
    if (options.solid != SolidKind::three_element && settings.model_out) {
      throw InputError("kolsky identify specimen: --model-out",
                       "writes a material file, which is a three-element solid",
                       "leave --solid or --model-out out");
    }
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

std::vector<Shot> read_shots(const Settings& settings, const std::optional<BarModelFile>& bars) {
  std::vector<Shot> shots = captured_shots(settings.captures);
  for (const Shot& shot : shots) {
    require_specimen(shot);
    if (bars) {
      require_holds(*bars, shot);
    } else if (shot.bar_model) {
      require_bar_model_holds(*shot.bar_model, shot, "the capture's bar model");
    }
  }
  return shots;
}

bool elastic_bars(const Bench& bench) {
  return bench.input.youngs_modulus_Pa && bench.output && bench.output->youngs_modulus_Pa;
}

Outcome identify(const Settings& settings) {
  Outcome outcome;
  if (settings.bar_model) {
    outcome.bars = read_bar_model(*settings.bar_model);
    require_band(*outcome.bars, settings.band_limit_Hz);
  }
  SpecimenFitOptions options = fit_options(settings, outcome.bars);
  outcome.shots = read_shots(settings, outcome.bars);
  const Shot& first = outcome.shots.front();
  const BarPrior prior = outcome.bars      ? outcome.bars->prior
                         : first.bar_model ? BarPrior(*first.bar_model)
                                           : BarPrior(assumed_bars(first.bench));
  if (const auto& identified = prior.material.identified; identified && !options.most_band_Hz) {
    options.most_band_Hz = identified->band_limit_Hz;
  }
  require_band_known(prior.material, settings.band_limit_Hz, "the capture's bar model");
  try {
    outcome.fit = fit_specimen(outcome.shots, prior, options);
  } catch (const InputError& error) {
    throw in_captures(error, settings.captures);
  }
  if (outcome.bars) {
    const std::string unchecked = temperature_unchecked(*outcome.bars, outcome.shots.front());
    if (!unchecked.empty()) {
      outcome.fit.warnings.push_back("the bar model was " + unchecked);
    }
  }
  SpectralOptions spectral;
  spectral.bars = outcome.fit.theory.bars;
  try {
    outcome.spectral = estimate_spectrum(outcome.shots, prior.material, spectral);
    for (std::string& warning : contradiction(outcome.fit, outcome.spectral->parameters)) {
      outcome.spectral->warnings.push_back(std::move(warning));
    }
  } catch (const InputError& error) {
    outcome.spectral_refused = error.what();
  }
  return outcome;
}

std::string bars_in_words(const Outcome& outcome) {
  const Shot& first = outcome.shots.front();
  if (elastic_bars(first.bench)) {
    return "elastic, moduli from the bench";
  }
  if (outcome.bars) {
    return outcome.bars->name;
  }
  return first.bar_model ? first.bar_model->source
                         : paper_pmma().source + ", assumed because no bar model was given";
}

JsonObject numbers(const std::vector<FittedNumber>& list) {
  JsonObject object;
  for (const FittedNumber& number : list) {
    object.push_back({number.name, JsonObject{{"value", number.value}, {"sd", number.sd}}});
  }
  return object;
}

/// The complex wavenumber k - i alpha = w sqrt(rho (J1 - i J2)) of a thin rod of the specimen's
/// material: paper, (9).
Complex wavenumber_of(const CompliancePoint& point, double density_kg_m3) {
  return 2.0 * std::numbers::pi * point.frequency_Hz *
         std::sqrt(density_kg_m3 * Complex(point.J1_per_Pa, -point.J2_per_Pa));
}

/// @param density  none filed: no wavenumber
JsonObject describe(const std::vector<CompliancePoint>& spectrum,
                    const std::optional<Measured>& density) {
  const auto column = [&](double CompliancePoint::*member) {
    std::vector<double> values;
    values.reserve(spectrum.size());
    for (const CompliancePoint& point : spectrum) {
      values.push_back(point.*member);
    }
    return values;
  };
  JsonObject object{{"frequency_Hz", column(&CompliancePoint::frequency_Hz)},
                    {"J1_per_Pa", column(&CompliancePoint::J1_per_Pa)},
                    {"J1_sd", column(&CompliancePoint::J1_sd)},
                    {"J1_sd_of_mean", column(&CompliancePoint::J1_sd_of_mean)},
                    {"J2_per_Pa", column(&CompliancePoint::J2_per_Pa)},
                    {"J2_sd", column(&CompliancePoint::J2_sd)},
                    {"J2_sd_of_mean", column(&CompliancePoint::J2_sd_of_mean)}};
  if (density) {
    std::vector<double> alpha_per_m;
    std::vector<double> wavenumber_per_m;
    for (const CompliancePoint& point : spectrum) {
      const Complex wavenumber = wavenumber_of(point, *density);
      alpha_per_m.push_back(-wavenumber.imag());
      wavenumber_per_m.push_back(wavenumber.real());
    }
    object.push_back({"alpha_per_m", std::move(alpha_per_m)});
    object.push_back({"wavenumber_per_m", std::move(wavenumber_per_m)});
  }
  return object;
}

JsonValue spectral_json(const Outcome& outcome) {
  if (!outcome.spectral) {
    return JsonObject{{"refused", outcome.spectral_refused}};
  }
  return JsonObject{{"parameters", numbers(outcome.spectral->parameters)},
                    {"spectrum", describe(outcome.spectral->spectrum,
                                          outcome.shots.front().bench.specimen->density_kg_m3)},
                    {"band_limit_Hz", outcome.spectral->band_limit_Hz},
                    {"window_s", outcome.spectral->window_s},
                    {"separation", name_of(outcome.spectral->separation)},
                    {"warnings", outcome.spectral->warnings}};
}

std::string name_of_theory(WaveTheory theory) {
  return theory == WaveTheory::elementary ? "elementary"
         : theory == WaveTheory::love     ? "love"
                                          : "exact";
}

JsonObject describe(const ShpbTheory& theory) {
  return {{"bars", name_of_theory(theory.bars)}, {"specimen", name_of(theory.specimen)}};
}

/// What three elements make of the same records; nothing where the family is those.
JsonValue three_element_json(const SpecimenFit& fit) {
  if (!fit.three_element) {
    return nullptr;
  }
  return JsonObject{{"parameters", numbers(fit.three_element->parameters)},
                    {"chi2_gain", fit.three_element->chi2_gain}};
}

/// A list of what was said of each, as `identify bar` gives it.
JsonList shots_of(const Outcome& outcome) {
  JsonList list;
  for (const Shot& shot : outcome.shots) {
    list.emplace_back(JsonObject{{"capture", shot.id}});
  }
  return list;
}

JsonValue describe(const Outcome& outcome) {
  const SpecimenFit& fit = outcome.fit;
  JsonList covariance;
  for (const auto& row : fit.covariance) {
    covariance.push_back(row);
  }
  JsonList tried;
  for (const TriedTheory& theory : fit.tried) {
    JsonObject entry = describe(theory.theory);
    entry.push_back({"chi2", theory.chi2});
    entry.push_back({"solid", name_of(theory.solid)});
    entry.push_back({"refused", theory.refused.empty() ? JsonValue(nullptr) : theory.refused});
    tried.push_back(std::move(entry));
  }
  const bool assumed = !elastic_bars(outcome.shots.front().bench) && !outcome.bars &&
                       !outcome.shots.front().bar_model;
  return JsonObject{
      {"solid", name_of(fit.solid)},
      {"parameters", numbers(fit.parameters)},
      {"covariance", std::move(covariance)},
      {"spectrum", describe(fit.spectrum, outcome.shots.front().bench.specimen->density_kg_m3)},
      {"chi2_reduced", fit.chi2_reduced},
      {"degrees_of_freedom", static_cast<std::uint64_t>(fit.degrees_of_freedom)},
      {"theory", describe(fit.theory)},
      {"tried", std::move(tried)},
      {"three_element", three_element_json(fit)},
      {"band_limit_Hz", fit.band_limit_Hz},
      {"judged_s", fit.judged_s},
      {"past_first_return", fit.to_the_end},
      {"bench", numbers(fit.bench)},
      {"budget", budget_json(parameter_budget(fit.parameters, fit.by_bench, fit.bench),
                             names_of(fit.parameters))},
      {"spectral", spectral_json(outcome)},
      {"bar_model", bars_in_words(outcome)},
      {"bar_model_assumed", assumed},
      {"shots", shots_of(outcome)},
      {"warnings", fit.warnings}};
}

std::string table_of(const std::vector<FittedNumber>& list) {
  std::string text;
  for (const FittedNumber& p : list) {
    text +=
        fmt::format("    {:<12}{:>12.5g} ± {:.2g} %\n", p.name, p.value, 100.0 * p.sd / p.value);
  }
  return text;
}

std::string report(const Outcome& outcome) {
  const SpecimenFit& fit = outcome.fit;
  std::string text = fmt::format("specimen from {} shot{}, bars: {}\n", outcome.shots.size(),
                                 outcome.shots.size() == 1 ? "" : "s", bars_in_words(outcome));
  text += fmt::format("  direct fit to the records ({}, up to {}, {} of each record)\n",
                      name_of(fit.solid), with_unit(fit.band_limit_Hz, "Hz"),
                      with_unit(fit.judged_s, "s"));
  text += table_of(fit.parameters);
  text += budget_table(parameter_budget(fit.parameters, fit.by_bench, fit.bench),
                       names_of(fit.parameters));
  text += fmt::format("    chi2 per degree of freedom {:.3f} ({} of them); bars {}, specimen {}\n",
                      fit.chi2_reduced, fit.degrees_of_freedom, name_of_theory(fit.theory.bars),
                      name_of(fit.theory.specimen));
  for (const TriedTheory& tried : fit.tried) {
    text +=
        fmt::format("      tried: bars {:<10} specimen {:<9} {}{}\n",
                    name_of_theory(tried.theory.bars), name_of(tried.theory.specimen),
                    tried.refused.empty() ? fmt::format("chi2 {:.1f}", tried.chi2) : tried.refused,
                    tried.solid == fit.solid ? "" : ", three elements");
  }
  if (fit.three_element) {
    text +=
        fmt::format("    three elements leave {:.1f} more of chi2\n", fit.three_element->chi2_gain);
  }
  if (outcome.spectral) {
    text += fmt::format("  strain over stress, frequency by frequency (eq. 25, up to {})\n",
                        with_unit(outcome.spectral->band_limit_Hz, "Hz"));
    text += table_of(outcome.spectral->parameters);
    if (outcome.spectral->separation == Separation::equilibrium) {
      text += "    waves overlap: told apart by the output bar's force, as if in equilibrium\n";
    }
    for (const std::string& warning : outcome.spectral->warnings) {
      text += "    warning: " + warning + "\n";
    }
  } else {
    text += "  no estimate from the histories: " + outcome.spectral_refused + "\n";
  }
  for (const std::string& warning : fit.warnings) {
    text += "  warning: " + warning + "\n";
  }
  return text;
}

void write_material(const Outcome& outcome, const std::string& path) {
  const SpecimenFit& fit = outcome.fit;
  const Bench& bench = outcome.shots.front().bench;
  if (!bench.specimen->density_kg_m3 || !bench.specimen->poisson_ratio) {
    throw InputError("kolsky identify specimen: --model-out",
                     "needs the specimen's density and Poisson's ratio, which the bench lacks",
                     "file specimen.density_kg_m3 and specimen.poisson_ratio");
  }
  Material material;
  material.density_kg_m3 = *bench.specimen->density_kg_m3;
  material.poisson_ratio = *bench.specimen->poisson_ratio;
  material.E1_Pa = {fit.parameters[0].value, fit.parameters[0].sd};
  material.E2_Pa = {fit.parameters[1].value, fit.parameters[1].sd};
  material.eta2_Pa_s = {fit.parameters[2].value, fit.parameters[2].sd};
  material.source =
      fmt::format("kolsky identify specimen, {} shots, chi2 per degree of freedom {:.3f}",
                  outcome.shots.size(), fit.chi2_reduced);
  std::string text = format_material(material) + "covariance = [";
  for (const auto& row : fit.covariance) {
    for (const double value : row) {
      text += fmt::format("{:.17e}, ", value);
    }
  }
  text += fmt::format("]\n\n[identified]\nshots = {}\nband_limit_Hz = {:.1f}\n",
                      outcome.shots.size(), fit.band_limit_Hz);
  if (const auto temperature_K = temperature_of(outcome.shots.front())) {
    text += fmt::format("temperature_K = {:.3f}\n", *temperature_K);
  }
  NewFile file(path);
  file.write(text);
  file.publish(kReadableByAll);
}

int run(const Settings& settings, Context& context) {
  const Outcome outcome = identify(settings);
  if (settings.model_out) {
    write_material(outcome, *settings.model_out);
  }
  context.out << (context.json ? to_text(describe(outcome)) + "\n" : report(outcome));
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
      "  kolsky identify specimen shot*.h5 --solid fractional --dispersion exact\n";
  command.arguments = {
      needed("CAPTURE", "", "captures of one bench and material", &s.captures),
      option("--bar-model", "M.toml",
             "material file of viscoelastic bars; its deviations count. Else the capture's own, "
             "else the paper's PMMA",
             &s.bar_model),
      option("--model-out", "S.toml", "material file to write: values, deviations, covariance",
             &s.model_out),
      option("--solid", "FAMILY",
             "three-element (default), four-element-fluid, two-kelvin, three-kelvin or fractional",
             &s.solid),
      option("--dispersion", "THEORY",
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
             &s.window_s)};
  command.run = [settings](Context& context) { return run(*settings, context); };
  return command;
}

}  // namespace kolsky::cli

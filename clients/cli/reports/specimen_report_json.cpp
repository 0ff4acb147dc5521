#include <complex>
#include <numbers>
#include <utility>

#include "clients/cli/reports/budget.hpp"
#include "clients/cli/reports/fit_draws.hpp"
#include "clients/cli/reports/specimen_report.hpp"
#include "processing/identification/parameter_budget.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky::cli {
namespace {

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

JsonValue spectral_json(const IdentifiedSpecimen& outcome) {
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

JsonObject describe(const ShpbTheory& theory) {
  return {{"bars", name_of(theory.bars)}, {"specimen", name_of(theory.specimen)}};
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
JsonList shots_of(const IdentifiedSpecimen& outcome) {
  JsonList list;
  for (const Shot& shot : outcome.shots) {
    list.emplace_back(JsonObject{{"capture", shot.id}});
  }
  return list;
}

}  // namespace

JsonValue describe(const IdentifiedSpecimen& outcome) {
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
  const bool assumed = takes_bar_model(outcome.shots.front().bench) && !outcome.bars &&
                       !outcome.shots.front().bar_model;
  return JsonObject{
      {"solid", name_of(fit.solid)},
      {"lossless", fit.lossless},
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
      {"draws", describe(outcome.draws)},
      {"spectral", spectral_json(outcome)},
      {"bar_model", bars_in_words(outcome)},
      {"bar_model_assumed", assumed},
      {"shots", shots_of(outcome)},
      {"warnings", fit.warnings}};
}

}  // namespace kolsky::cli

#include <cmath>

#include "clients/cli/reports/bar_report.hpp"
#include "clients/cli/reports/budget.hpp"
#include "clients/cli/reports/fit_draws.hpp"
#include "processing/identification/better_solid.hpp"
#include "processing/identification/parameter_budget.hpp"

namespace kolsky::cli {
namespace {

JsonObject numbers(const std::vector<FittedNumber>& list) {
  JsonObject object;
  for (const FittedNumber& number : list) {
    object.push_back({number.name, JsonObject{{"value", number.value}, {"sd", number.sd}}});
  }
  return object;
}

JsonList rows(const std::vector<std::vector<double>>& matrix) {
  JsonList list;
  for (const auto& row : matrix) {
    list.push_back(row);
  }
  return list;
}

JsonList correlation(const std::vector<std::vector<double>>& covariance) {
  JsonList list;
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    std::vector<double> row;
    for (std::size_t j = 0; j < covariance.size(); ++j) {
      row.push_back(covariance[i][j] / std::sqrt(covariance[i][i] * covariance[j][j]));
    }
    list.push_back(row);
  }
  return list;
}

JsonObject describe(const BarSpectrum& spectrum) {
  return {{"frequency_Hz", spectrum.frequency_Hz},
          {"J1_per_Pa", spectrum.J1_per_Pa.mean},
          {"J1_sd", spectrum.J1_per_Pa.sd},
          {"J1_sd_of_mean", spectrum.J1_per_Pa.sd_of_mean},
          {"J2_per_Pa", spectrum.J2_per_Pa.mean},
          {"J2_sd", spectrum.J2_per_Pa.sd},
          {"J2_sd_of_mean", spectrum.J2_per_Pa.sd_of_mean},
          {"alpha_per_m", spectrum.alpha_per_m.mean},
          {"alpha_sd", spectrum.alpha_per_m.sd},
          {"alpha_sd_of_mean", spectrum.alpha_per_m.sd_of_mean},
          {"wavenumber_per_m", spectrum.wavenumber_per_m.mean},
          {"wavenumber_sd", spectrum.wavenumber_per_m.sd},
          {"wavenumber_sd_of_mean", spectrum.wavenumber_per_m.sd_of_mean}};
}

JsonObject describe(const ChoiceByEvidence& choice) {
  return {{"asked", choice.asked},
          {"told_apart", choice.told_apart},
          {"log_evidence_ahead", choice.ahead}};
}

JsonList describe(const std::vector<Alternative>& alternatives) {
  JsonList list;
  for (const Alternative& a : alternatives) {
    JsonObject entry = {{"dispersion", name_of(a.theory.waves)},
                        {"solid", a.theory.lossless ? "elastic" : name_of(a.theory.solid)},
                        {"far_end", name_of(a.theory.far_end)}};
    if (a.failed.empty()) {
      entry.push_back({"log_evidence", a.log_evidence});
      entry.push_back({"chi2_reduced", a.chi2_reduced});
      entry.push_back({"left_behind", a.left_behind});
    } else {
      entry.push_back({"failed", a.failed});
    }
    list.push_back(std::move(entry));
  }
  return list;
}

/// null where the model fits.
JsonValue describe(const std::optional<CommonMisfit>& misfit) {
  if (!misfit) {
    return nullptr;
  }
  return JsonObject{{"low_Hz", misfit->low_Hz},
                    {"high_Hz", misfit->high_Hz},
                    {"over_noise", misfit->power},
                    {"deviations_from_chance", misfit->deviations}};
}

/// null where nothing is clearly ahead of three elements.
JsonValue describe(const std::optional<BetterSolid>& better) {
  if (!better) {
    return nullptr;
  }
  return JsonObject{{"solid", name_of(better->solid)},
                    {"log_evidence_ahead", better->log_evidence_ahead},
                    {"chi2_reduced", better->chi2_reduced}};
}

JsonList shots_of(const BarIdentification& result) {
  JsonList list;
  for (std::size_t i = 0; i < result.three_element.shots.size(); ++i) {
    const ShotEstimate& shot = result.three_element.shots[i];
    list.push_back(JsonObject{{"capture", result.shot_ids[i]},
                              {"parameters", numbers(shot.parameters)},
                              {"chi2_reduced", shot.chi2_reduced}});
  }
  return list;
}

JsonObject describe(const BarFit& fit) {
  JsonObject object = {
      {"solid", name_of(fit.solid)},        {"parameters", numbers(fit.parameters)},
      {"covariance", rows(fit.covariance)}, {"correlation", correlation(fit.covariance)},
      {"chi2_reduced", fit.chi2_reduced},   {"log_evidence", fit.log_evidence}};
  if (fit.reflection) {
    object.push_back(
        {"reflection", JsonObject{{"value", fit.reflection->value}, {"sd", fit.reflection->sd}}});
  }
  return object;
}

JsonList describe(const std::vector<ForetoldShot>& foretold) {
  JsonList list;
  for (const ForetoldShot& shot : foretold) {
    JsonObject gauges;
    for (const ForetoldGauge& gauge : shot.gauges) {
      std::vector<double> residual(gauge.measured);
      for (std::size_t n = 0; n < residual.size(); ++n) {
        residual[n] -= gauge.foretold[n];
      }
      gauges.push_back({gauge.name, JsonObject{{"measured", gauge.measured},
                                               {"predicted", gauge.foretold},
                                               {"residual", std::move(residual)}}});
    }
    list.push_back(
        JsonObject{{"capture", shot.id}, {"time_s", shot.time_s}, {"gauges", std::move(gauges)}});
  }
  return list;
}

}  // namespace

JsonValue describe(const BarIdentification& result, const std::vector<ForetoldShot>& foretold,
                   const std::optional<FitDraws>& draws) {
  const BarFit& three = result.three_element;
  JsonObject object = {
      {"parameters", numbers(three.parameters)},
      {"covariance", rows(three.covariance)},
      {"correlation", correlation(three.covariance)},
      {"chi2_reduced", three.chi2_reduced},
      {"degrees_of_freedom", static_cast<std::uint64_t>(three.degrees_of_freedom)},
      {"misfit", describe(three.misfit)},
      {"passive", !result.spectrum.mean_loss.gains()},
      {"dispersion", name_of(three.theory)},
      {"far_end", name_of(three.far_end)},
      {"two_passes", result.two_passes},
      {"band_limit_Hz", three.band_limit_Hz},
      {"choice", JsonObject{{"dispersion", describe(result.wave_theory)},
                            {"far_end", describe(result.far_end)},
                            {"solid", describe(result.solid)}}},
      {"alternatives", describe(result.alternatives)},
      {"better_solid", describe(better_solid(result))},
      {"solid", describe(result.fit)},
      {"bench", numbers(three.bench)},
      {"budget", budget_json(parameter_budget(three.parameters, three.by_bench, three.bench),
                             names_of(three.parameters))},
      {"draws", describe(draws)},
      {"over_shots", numbers(result.over_shots)},
      {"shots", shots_of(result)},
      {"spectrum", describe(result.spectrum)},
      {"least_squares", JsonObject{{"parameters", numbers(result.paper)},
                                   {"spectrum", describe(result.straight_lines)}}},
      {"warnings", result.warnings}};
  if (!foretold.empty()) {
    object.push_back({"waveforms", describe(foretold)});
  }
  return object;
}

}  // namespace kolsky::cli

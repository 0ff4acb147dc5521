#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/reduced_shot.hpp"
#include "clients/cli/reports/time_text.hpp"
#include "processing/reduction/true_values.hpp"
#include "processing/reduction/validity.hpp"

namespace kolsky::cli {
namespace {

JsonValue describe(const LoopSummary& summary) {
  if (!summary.no_loading.empty()) {
    return JsonObject{{"peak_stress_Pa", nullptr}, {"strain_at_peak", nullptr},
                      {"peak_strain", nullptr},    {"mean_strain_rate_per_s", nullptr},
                      {"loading_s", nullptr},      {"no_loading", summary.no_loading}};
  }
  return JsonObject{{"peak_stress_Pa", summary.peak_stress_Pa},
                    {"strain_at_peak", summary.strain_at_peak},
                    {"peak_strain", summary.peak_strain},
                    {"mean_strain_rate_per_s", summary.mean_strain_rate_per_s},
                    {"loading_s", summary.loading_s},
                    {"no_loading", nullptr}};
}

JsonValue describe(const Quotable& part) {
  return JsonObject{
      {"any", part.any},   {"assumed", part.assumed},         {"from_s", part.from_s},
      {"to_s", part.to_s}, {"from_strain", part.from_strain}, {"to_strain", part.to_strain},
      {"text", part.text}};
}

JsonValue describe(const SpectralQuality& quality) {
  return JsonObject{{"frequency_Hz", quality.frequency_Hz},
                    {"input_dB", quality.input_dB},
                    {"output_dB", quality.output_dB}};
}

JsonValue describe(const Quality& quality, const ReducedShot& reduced) {
  const SpectralQuality spectral = spectral_quality(reduced.shot, reduced.reduction);
  JsonObject object = describe_checks(quality);
  object.push_back({"quotable", describe(quotable_part(reduced.reduction))});
  object.push_back({"equilibrium", disagreement(reduced.reduction)});
  object.push_back({"useful_band_Hz", spectral.useful_band_Hz});
  object.push_back({"signal_to_noise", describe(spectral)});
  return object;
}

}  // namespace

JsonObject describe_checks(const Quality& quality) {
  JsonObject checks;
  for (const Check& check : quality.checks) {
    checks.push_back({check.name, JsonObject{{"value", check.value},
                                             {"limit", check.limit},
                                             {"unit", check.unit},
                                             {"verdict", verdict_name(check.verdict)},
                                             {"text", check.text}}});
  }
  return {{"reducible", quality.reducible},
          {"reason", quality.reason},
          {"verdict", verdict_name(quality.verdict())},
          {"checks", std::move(checks)}};
}

JsonValue describe_request(const ReductionRequest& request) {
  JsonObject object;
  for (const auto& [key, word] : kRequestWords) {
    if (request.*word) {
      object.push_back({key, *(request.*word)});
    }
  }
  for (const auto& [key, number] : kRequestNumbers) {
    if (request.*number) {
      object.push_back({key, *(request.*number)});
    }
  }
  if (request.with_true) {
    object.push_back({kRequestTrue, true});
  }
  return object;
}

JsonValue describe_meta(const std::map<std::string, std::string>& meta) {
  JsonObject object;
  for (const auto& [key, value] : meta) {
    object.push_back({key, value});
  }
  return object;
}

JsonValue describe(const ReducedShot& reduced) {
  if (reduced.shot.bench.kind == BenchKind::impact) {
    return describe_ball(reduced);
  }
  const Reduction& reduction = reduced.reduction;
  const bool found = reduction.arrival_s != 0.0 || reduction.band_limit_Hz > 0.0;
  const auto if_found = [&](double number) {
    return found ? JsonValue(number) : JsonValue(nullptr);
  };
  JsonObject object = {{"capture", reduced.capture},
                       {"shot", reduced.shot.id},
                       {"time", iso_time(reduced.shot.utc_ns)},
                       {"meta", describe_meta(reduced.shot.meta)},
                       {"bar_model", reduction.bar_model},
                       {"bar_model_assumed", reduced.default_bar_model},
                       {"arrival_s", if_found(reduction.arrival_s)},
                       {"arrival_sigma_s", if_found(reduction.arrival_sigma_s)},
                       {"band_limit_Hz", if_found(reduction.band_limit_Hz)},
                       {"separation", name_of(reduction.separation)},
                       {"quality", describe(reduction.quality, reduced)},
                       {"dispersion", name_of(reduction.theory)},
                       {"stress_from", name_of(reduction.stress_from)},
                       {"corrections", names_of(reduction.corrections)},
                       {"summary", describe(summarise(reduction))},
                       {"time_s", reduction.time_s},
                       {"stress_Pa", reduction.stress_Pa},
                       {"strain", reduction.strain},
                       {"strain_rate_per_s", reduction.strain_rate_per_s},
                       {"force_front_N", reduction.force_front_N},
                       {"force_back_N", reduction.force_back_N},
                       {"incident", reduction.incident},
                       {"reflected", reduction.reflected},
                       {"transmitted", reduction.transmitted}};
  if (reduced.request.asks()) {
    object.push_back({"asked", describe_request(reduced.request)});
  }
  if (reduced.uncertainty) {
    describe_uncertainty(*reduced.uncertainty, reduction.separation != Separation::equilibrium,
                         object);
  }
  if (reduced.as_filed) {
    const Reduction& before = *reduced.as_filed;
    object.push_back({"bench", *reduced.bench});
    object.push_back({"as_filed", JsonObject{{"reducible", before.quality.reducible},
                                             {"verdict", verdict_name(before.quality.verdict())},
                                             {"summary", describe(summarise(before))},
                                             {"time_s", before.time_s},
                                             {"stress_Pa", before.stress_Pa},
                                             {"strain", before.strain},
                                             {"strain_rate_per_s", before.strain_rate_per_s}}});
  }
  if (reduced.request.with_true) {
    object.push_back({"strain_true", true_strain(reduction)});
    object.push_back({"stress_true_Pa", true_stress_Pa(reduction)});
  }
  return object;
}

}  // namespace kolsky::cli

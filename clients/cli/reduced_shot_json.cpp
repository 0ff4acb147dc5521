#include "clients/cli/reduced_shot.hpp"
#include "clients/cli/time_text.hpp"

namespace kolsky::cli {
namespace {

JsonValue describe(const Quality& quality) {
  JsonObject checks;
  for (const Check& check : quality.checks) {
    checks.push_back({check.name, JsonObject{{"value", check.value},
                                             {"limit", check.limit},
                                             {"unit", check.unit},
                                             {"verdict", verdict_name(check.verdict)},
                                             {"text", check.text}}});
  }
  return JsonObject{{"reducible", quality.reducible},
                    {"reason", quality.reason},
                    {"verdict", verdict_name(quality.verdict())},
                    {"checks", std::move(checks)}};
}

JsonValue describe(const LoopSummary& summary) {
  return JsonObject{{"peak_stress_Pa", summary.peak_stress_Pa},
                    {"strain_at_peak", summary.strain_at_peak},
                    {"peak_strain", summary.peak_strain},
                    {"mean_strain_rate_per_s", summary.mean_strain_rate_per_s},
                    {"loading_s", summary.loading_s}};
}

JsonObject describe(const std::map<std::string, std::string>& meta) {
  JsonObject object;
  for (const auto& [key, value] : meta) {
    object.push_back({key, value});
  }
  return object;
}

}  // namespace

JsonValue describe(const ReducedShot& reduced, bool with_true) {
  const Reduction& reduction = reduced.reduction;
  JsonObject object = {{"capture", reduced.capture},
                       {"shot", reduced.shot.id},
                       {"time", iso_time(reduced.shot.utc_ns)},
                       {"meta", describe(reduced.shot.meta)},
                       {"bar_model", reduction.bar_model},
                       {"bar_model_assumed", reduced.default_bar_model},
                       {"arrival_s", reduction.arrival_s},
                       {"arrival_sigma_s", reduction.arrival_sigma_s},
                       {"band_limit_Hz", reduction.band_limit_Hz},
                       {"quality", describe(reduction.quality)},
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
  if (with_true) {
    object.push_back({"strain_true", true_strain(reduction)});
    object.push_back({"stress_true_Pa", true_stress_Pa(reduction)});
  }
  return object;
}

}  // namespace kolsky::cli

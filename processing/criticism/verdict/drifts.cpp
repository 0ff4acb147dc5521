#include "processing/criticism/verdict/drifts.hpp"

#include <cmath>

namespace kolsky {

namespace {

constexpr const char* kDrift = "baseline-drift";

}  // namespace

Model with_drift(const Model& model, const std::string& gauge) {
  Model drifting = model;
  EffectUse drift = null_use(*find_effect(kDrift), gauge);
  if (drifting.find(drift.id()) == nullptr) {
    drifting.effects.push_back(std::move(drift));
  }
  return drifting;
}

Model with_drifts(const Model& model, const Bench& bench) {
  Model drifting = model;
  for (const Gauge& gauge : bench.gauges) {
    drifting = with_drift(drifting, gauge.name);
  }
  return drifting;
}

std::vector<std::string> drifting_gauges(const Model& fitted) {
  constexpr double kKnown = 3.0;
  std::vector<std::string> list;
  for (const EffectUse& use : fitted.effects) {
    const ModelValue& rate = use.values.front();
    if (use.effect->about().id == kDrift && std::abs(rate.value) > kKnown * rate.sd) {
      list.push_back(use.id());
    }
  }
  return list;
}

}  // namespace kolsky

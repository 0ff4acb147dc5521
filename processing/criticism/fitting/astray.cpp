#include "processing/criticism/fitting/astray.hpp"

#include <algorithm>
#include <cmath>

namespace kolsky {

namespace {

/// kFarOff of a specimen, whose spring becomes rigid for little: what is missing moves it decades.
constexpr double kSpecimenFarOff = 1.2;

bool nothing_holds(const ModelValue& value) {
  return value.free && value.prior_sd == 0.0 && value.sd > std::abs(value.value);
}

bool found_by_a_fit(const ModelValue& value) {
  return value.free && value.prior_sd == 0.0 && value.sd > 0.0 && !value.bounds;
}

}  // namespace

bool astray(const Model& fitted, const Misfit& misfit) {
  const EffectUse* specimen = fitted.find("three-element-specimen");
  const bool moves =
      specimen != nullptr && std::ranges::any_of(specimen->values, &ModelValue::free);
  return misfit.chi2_reduced > (moves ? kSpecimenFarOff : kFarOff) ||
         std::ranges::any_of(fitted.effects, [](const EffectUse& use) {
           return use.effect->about().base && std::ranges::any_of(use.values, nothing_holds);
         });
}

std::optional<Model> begun_afresh(const Model& model) {
  Model afresh = model;
  bool any = false;
  for (EffectUse& use : afresh.effects) {
    const EffectAbout& about = use.effect->about();
    const bool material = about.stage == Stage::material || about.stage == Stage::specimen;
    if (about.base && material && std::ranges::all_of(use.values, found_by_a_fit)) {
      use = null_use(*use.effect, use.gauge);
      any = true;
    }
    for (ModelValue& value : use.values) {
      if (value.free && value.prior_sd > 0.0 && value.value != value.prior_mean) {
        value.value = value.prior_mean;
        any = true;
      }
    }
  }
  return any ? std::optional(std::move(afresh)) : std::nullopt;
}

}  // namespace kolsky

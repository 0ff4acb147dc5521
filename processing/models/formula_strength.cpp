#include "processing/models/formula_strength.hpp"

#include <cmath>

namespace kolsky {

namespace {

constexpr double kDeviations = 3.0;
constexpr double kTenth = 0.1;

const EffectParameter& strength_of(const EffectUse& use) {
  return use.effect->about().parameters[use.effect->about().strength];
}

const ModelValue& fitted_strength(const EffectUse& use) {
  return use.values[use.effect->about().strength];
}

bool known(const EffectUse& fitted, double deviations) {
  const ModelValue& own = fitted_strength(fitted);
  return std::abs(own.value) > deviations * own.sd;
}

}  // namespace

bool has_formula(const EffectUse& use) {
  return !use.effect->about().parameters.empty() && strength_of(use).by_formula != 0.0;
}

bool agrees_with_formula(const EffectUse& fitted, double share) {
  if (!has_formula(fitted)) {
    return false;
  }
  const double formula = strength_of(fitted).by_formula;
  const ModelValue& own = fitted_strength(fitted);
  const double off = std::abs(own.value - formula);
  return off < kDeviations * own.sd || off < share * formula;
}

bool may_be_its_formula(const EffectUse& fitted) {
  const double formula = has_formula(fitted) ? strength_of(fitted).by_formula : 0.0;
  return agrees_with_formula(fitted, kTenth) && known(fitted, kDeviations) &&
         std::abs(fitted_strength(fitted).value - formula) < formula;
}

bool is_its_formula(const EffectUse& fitted) {
  // What is less well known may be most of anything else.
  constexpr double kWellKnown = 10.0;
  return may_be_its_formula(fitted) && known(fitted, kWellKnown);
}

bool allowed_by_formula(const EffectUse& fitted) {
  constexpr double kAllowed = 0.25;  // while effects beside it may be missing
  const auto& parameters = fitted.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].only_by_formula && fitted.values[p].value != parameters[p].starts.front()) {
      return agrees_with_formula(fitted, kAllowed);
    }
  }
  return true;
}

}  // namespace kolsky

#include "processing/criticism/auxiliary_starts.hpp"

#include <cmath>

namespace kolsky {

namespace {

/// All strengths of an effect are at null: its auxiliary parameters mean nothing yet.
bool is_null(const EffectUse& use) {
  const std::vector<EffectParameter>& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!parameters[p].auxiliary() && use.values[p].value != parameters[p].null_value) {
      return false;
    }
  }
  return true;
}

bool is_open(const EffectUse& use, std::size_t p) {
  const EffectParameter& parameter = use.effect->about().parameters[p];
  return use.values[p].free && parameter.auxiliary() && (parameter.chosen || is_null(use));
}

}  // namespace

Model at_best_starts(Model model, const Campaign& campaign,
                     const std::function<double(const Composition&, bool first)>& objective) {
  for (std::size_t u = 0; u < model.effects.size(); ++u) {
    const std::vector<EffectParameter>& parameters = model.effects[u].effect->about().parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      if (!is_open(model.effects[u], p)) {
        continue;
      }
      Model best = model;
      double least = HUGE_VAL;
      for (const double start : parameters[p].starts) {
        ModelValue& value = model.effects[u].values[p];
        value.value = start;
        value.free = !parameters[p].chosen;
        const double own = objective(Composition(model, campaign), least == HUGE_VAL);
        if (own < least) {
          least = own;
          best = model;
        }
      }
      model = std::move(best);
    }
  }
  return model;
}

}  // namespace kolsky

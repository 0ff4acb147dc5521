#include "processing/criticism/fitting/effect_starts.hpp"

#include <cmath>
#include <vector>

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

/// Where fits of one of an effect's parameters begin, the best of which is gone on with; none where
/// it stays as it is.
std::vector<double> starts_of(const EffectUse& use, std::size_t p) {
  const EffectParameter& parameter = use.effect->about().parameters[p];
  const bool chosen = parameter.auxiliary() && parameter.chosen;
  if (!use.values[p].free || (!chosen && !is_null(use))) {
    return {};
  }
  if (parameter.auxiliary()) {
    return parameter.starts;
  }
  if (parameter.power == 1.0 && !parameter.sudden) {
    return {};
  }
  // First order at null says nothing of a large one.
  const double size = parameter.typical;
  return {0.0, 2.0 * size, 4.0 * size, 8.0 * size, 16.0 * size};
}

}  // namespace

Model at_best_starts(Model model, const Campaign& campaign,
                     const std::function<double(const Composition&, bool first)>& objective) {
  for (std::size_t u = 0; u < model.effects.size(); ++u) {
    const std::vector<EffectParameter>& parameters = model.effects[u].effect->about().parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      Model best = model;
      double least = HUGE_VAL;
      for (const double start : starts_of(model.effects[u], p)) {
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

#include "processing/criticism/verdict/strength_notes.hpp"

#include <fmt/format.h>

#include <cmath>

#include "processing/models/formula_strength.hpp"

namespace kolsky {

std::optional<std::string> unlike_formula_text(const EffectUse& fitted) {
  const EffectAbout& about = fitted.effect->about();
  const EffectParameter& strength = about.parameters[about.strength];
  const ModelValue& own = fitted.values[about.strength];
  constexpr double kMuch = 0.1;
  if (!has_formula(fitted) || agrees_with_formula(fitted, kMuch)) {
    return std::nullopt;
  }
  return fmt::format(
      "{}: {} is {:g} by its formula with the sizes filed, and {:.3g} ± {:.2g} here: unless these "
      "are wrong, something else does what it would do, or goes beside it",
      fitted.id(), strength.name, strength.by_formula, own.value, own.sd);
}

bool only_begins(const EffectUse& fitted) {
  constexpr double kKnown = 3.0;  // deviations
  bool strength_known = false;
  bool has_time = false;
  bool time_known = false;
  const EffectAbout& about = fitted.effect->about();
  for (std::size_t p = 0; p < about.parameters.size(); ++p) {
    const EffectParameter& parameter = about.parameters[p];
    const ModelValue& own = fitted.values[p];
    const bool known = std::abs(own.value - parameter.null_value) > kKnown * own.sd;
    const bool time = parameter.auxiliary() && parameter.unit == "s";
    has_time = has_time || (time && own.free);
    time_known = time_known || (time && known);
    strength_known = strength_known || (p == about.strength && known);
  }
  return has_time && !time_known && !strength_known;
}

std::optional<std::string> only_begins_text(const EffectUse& fitted) {
  if (!only_begins(fitted)) {
    return std::nullopt;
  }
  return fmt::format(
      "{}: the records tell neither its strength nor its time, only what both do together: the "
      "beginning of something slow, whatever it is; longer records tell",
      fitted.id());
}

}  // namespace kolsky

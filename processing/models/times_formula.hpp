#pragma once

#include "processing/models/effect.hpp"

namespace kolsky {

/// The strength of a correction by a formula without a free number: 0 without it and 1 as the
/// formula has it with the sizes filed. What asks for twenty times as much is something else.
[[nodiscard]] inline EffectParameter times_formula() {
  return {
      .name = "s", .unit = "-", .upper = 100.0, .typical = 0.2, .most = 20.0, .by_formula = 1.0};
}

}  // namespace kolsky

#pragma once

#include "processing/models/model.hpp"

namespace kolsky {

/// An effect as a fit left it: its first parameter with a deviation, all others at null.
inline EffectUse fitted_strength(const char* id, double value, double sd) {
  EffectUse use = null_use(*find_effect(id));
  use.values.front().value = value;
  use.values.front().sd = sd;
  return use;
}

}  // namespace kolsky

#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

const Effect& core_nonlinearity_effect();
const Effect& core_nonlinearity_effect() {
  static const LayerNonlinearity effect("core", &BallScene::core);
  return effect;
}

}  // namespace kolsky

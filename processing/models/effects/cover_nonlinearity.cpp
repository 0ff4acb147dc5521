#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

const Effect& cover_nonlinearity_effect();
const Effect& cover_nonlinearity_effect() {
  static const LayerNonlinearity effect("cover", &BallScene::cover);
  return effect;
}

}  // namespace kolsky

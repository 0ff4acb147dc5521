#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

const Effect& cover_second_relaxation_effect();
const Effect& cover_second_relaxation_effect() {
  static const LayerSecondRelaxation effect("cover", &BallScene::cover, 6e-11);
  return effect;
}

}  // namespace kolsky

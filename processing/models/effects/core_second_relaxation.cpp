#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

const Effect& core_second_relaxation_effect();
const Effect& core_second_relaxation_effect() {
  static const LayerSecondRelaxation effect("core", &BallScene::core, 4e-10);
  return effect;
}

}  // namespace kolsky

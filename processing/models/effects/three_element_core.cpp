#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

const Effect& three_element_core_effect();
const Effect& three_element_core_effect() {
  static const ThreeElementLayer effect("core", &BallScene::core,
                                        {1.21e8, 1.43e8, 2860.0, 1140.0, 0.376});
  return effect;
}

}  // namespace kolsky

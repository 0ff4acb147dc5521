#include "processing/models/ball_layer_effects.hpp"

namespace kolsky {

const Effect& three_element_cover_effect();
const Effect& three_element_cover_effect() {
  static const ThreeElementLayer effect("cover", &BallScene::cover,
                                        {9.87e8, 4.52e8, 6020.0, 960.0, 0.319});
  return effect;
}

}  // namespace kolsky

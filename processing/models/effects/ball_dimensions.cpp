#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

/// Where a deviation of either is filed.
class BallDimensions final : public Effect {
 public:
  BallDimensions()
      : Effect({
            .id = "ball-dimensions",
            .stage = Stage::bench,
            .definition = "true diameters of core and ball = filed + delta",
            .reference = "bench file",
            .kinds = {BenchKind::impact},
            .parameters = {{"delta_core", "m", 0.0, -2e-3, 2e-3, 1e-4, {}},
                           {"delta_ball", "m", 0.0, -2e-3, 2e-3, 1e-4, {}}},
            .told_only = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->core_diameter_m += values[0];
    scene.ball->outer_diameter_m += values[1];
  }
};

}  // namespace

const Effect& ball_dimensions_effect();
const Effect& ball_dimensions_effect() {
  static const BallDimensions effect;
  return effect;
}

}  // namespace kolsky

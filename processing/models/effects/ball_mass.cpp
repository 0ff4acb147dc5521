#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

/// Where a deviation of the mass is filed.
class BallMass final : public Effect {
 public:
  BallMass()
      : Effect({
            .id = "ball-mass",
            .stage = Stage::bench,
            .definition = "true densities of core and cover = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::impact},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .told_only = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->heavier += values[0];
  }
};

}  // namespace

const Effect& ball_mass_effect();
const Effect& ball_mass_effect() {
  static const BallMass effect;
  return effect;
}

}  // namespace kolsky

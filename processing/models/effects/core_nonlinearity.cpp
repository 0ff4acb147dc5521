#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class CoreNonlinearity final : public Effect {
 public:
  CoreNonlinearity()
      : Effect({
            .id = "core-nonlinearity",
            .stage = Stage::specimen,
            .definition =
                "instantaneous deviatoric stress x (1 + b strain), equivalent Hencky strain",
            .reference = "effects.md; docs/impact.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"b", "-", 0.0, -2.0, 20.0, 0.1, {}, false, 0.5}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->core.nonlinearity = values[0];
  }
};

}  // namespace

const Effect& core_nonlinearity_effect();
const Effect& core_nonlinearity_effect() {
  static const CoreNonlinearity effect;
  return effect;
}

}  // namespace kolsky

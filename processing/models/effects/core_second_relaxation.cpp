#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class CoreSecondRelaxation final : public Effect {
 public:
  CoreSecondRelaxation()
      : Effect({
            .id = "core-second-relaxation",
            .stage = Stage::specimen,
            .definition = "uniaxial J += D / (1 + s tau), in the chosen reading",
            .reference = "effects.md; docs/impact.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"D", "1/Pa", 0.0, 0.0, 1e-6, 4e-10, {}, false, 0.5},
                           {"tau", "s", 0.0, 1e-6, 2e-2, 2e-5, {5e-6, 2e-5, 6e-5, 2e-4, 6e-4}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->core.solid.relaxations.push_back({values[0], values[1]});
  }
};

}  // namespace

const Effect& core_second_relaxation_effect();
const Effect& core_second_relaxation_effect() {
  static const CoreSecondRelaxation effect;
  return effect;
}

}  // namespace kolsky

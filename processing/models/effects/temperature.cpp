#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class Temperature final : public Effect {
 public:
  Temperature()
      : Effect({
            .id = "temperature",
            .stage = Stage::material,
            .definition = "E1, E2 x (1 - c dT), dT logged per shot",
            .reference = "docs/methods/effects.md; Ferry 1980",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"c", "1/K", 0.0, -0.1, 0.1, 1e-3, {}}},
            .shot_facts = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (!scene.facts->warmer_by_K) {
      return;
    }
    const double factor = 1.0 - values[0] * *scene.facts->warmer_by_K;
    for (BarScene& bar : scene.bars) {
      bar.solid.E1_Pa *= factor;
      bar.solid.E2_Pa *= factor;
    }
  }
};

}  // namespace

const Effect& temperature_effect();
const Effect& temperature_effect() {
  static const Temperature effect;
  return effect;
}

}  // namespace kolsky

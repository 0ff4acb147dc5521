#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class FractionalDamping final : public Effect {
 public:
  FractionalDamping()
      : Effect({
            .id = "fractional-damping",
            .stage = Stage::material,
            .definition = "the Kelvin branch 1 / (E2 (1 + (s eta2/E2)^beta))",
            .reference = "docs/methods/effects.md; Cole and Cole 1941",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"beta", "-", 1.0, 0.05, 1.0, 0.02, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    for (BarScene& bar : scene.bars) {
      bar.solid.beta = values[0];
    }
  }
};

}  // namespace

const Effect& fractional_damping_effect();
const Effect& fractional_damping_effect() {
  static const FractionalDamping effect;
  return effect;
}

}  // namespace kolsky

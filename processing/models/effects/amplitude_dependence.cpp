#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class AmplitudeDependence final : public Effect {
 public:
  AmplitudeDependence()
      : Effect({
            .id = "amplitude-dependence",
            .stage = Stage::material,
            .definition = "all moduli x (1 + b peak strain of the shot, at the first gauge)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"b", "-", 0.0, -200.0, 200.0, 1.0, {}}},
            .shot_facts = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    const double factor = 1.0 + values[0] * scene.facts->peak_strain;
    for (BarScene& bar : scene.bars) {
      Solid& solid = bar.solid;
      solid.E1_Pa *= factor;
      solid.E2_Pa *= factor;
      solid.eta2_Pa_s *= factor;
      solid.phi_per_Pa_s /= factor;
      for (Solid::Relaxation& relaxation : solid.relaxations) {
        relaxation.D_per_Pa /= factor;
      }
    }
  }
};

}  // namespace

const Effect& amplitude_dependence_effect();
const Effect& amplitude_dependence_effect() {
  static const AmplitudeDependence effect;
  return effect;
}

}  // namespace kolsky

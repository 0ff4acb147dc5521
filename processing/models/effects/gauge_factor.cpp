#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class GaugeFactor final : public Effect {
 public:
  GaugeFactor()
      : Effect({
            .id = "gauge-factor",
            .stage = Stage::sensor,
            .definition = "reading x (1 + kappa)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"kappa", "-", 0.0, -0.9, 9.0, 0.01, {}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (Complex& factor : scene.gauges[gauge].factor) {
      factor *= 1.0 + values[0];
    }
  }
};

}  // namespace

const Effect& gauge_factor_effect();
const Effect& gauge_factor_effect() {
  static const GaugeFactor effect;
  return effect;
}

}  // namespace kolsky

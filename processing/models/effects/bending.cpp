#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class Bending final : public Effect {
 public:
  Bending()
      : Effect({
            .id = "bending",
            .stage = Stage::sensor,
            .definition =
                "reading += chi a w''/e0 of a Timoshenko beam struck off its axis; w'' is "
                "the rotation's slope, or the deflection's curvature",
            .reference = "docs/methods/effects.md; Timoshenko 1921",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"chi", "m", 0.0, -0.05, 0.05, 1e-5, {}},
                           // A fibre's strain is the slope of the section's rotation; without
                           // shear the deflection has the same curvature, and is often written.
                           {"deflection", "-", 0.0, 0.0, 1.0, 1.0, {0.0, 1.0}, false, 2e-3, true}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    for (GaugeScene& g : scene.gauges) {
      g.offset_m = values[0];
      g.bends_as_deflection = values[1] != 0.0;
    }
  }
};

}  // namespace

const Effect& bending_effect();
const Effect& bending_effect() {
  static const Bending effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class SpecimenDimensions final : public Effect {
 public:
  SpecimenDimensions()
      : Effect({
            .id = "specimen-dimensions",
            .stage = Stage::bench,
            .definition = "true length and diameter = filed + delta",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::shpb},
            .parameters = {{"delta_length", "m", 0.0, -2e-3, 2e-3, 5e-5, {}},
                           {"delta_diameter", "m", 0.0, -5e-3, 5e-3, 1e-4, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->length_m += values[0];
    scene.specimen->diameter_m += values[1];
  }
};

}  // namespace

const Effect& specimen_dimensions_effect();
const Effect& specimen_dimensions_effect() {
  static const SpecimenDimensions effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class SpecimenNonlinearity final : public Effect {
 public:
  SpecimenNonlinearity()
      : Effect({
            .id = "specimen-nonlinearity",
            .stage = Stage::specimen,
            .definition = "spring E1 -> E1 (1 + b strain)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::shpb},
            .parameters = {{"b", "-", 0.0, -20.0, 50.0, 0.2, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->stiffening = values[0];
  }
};

}  // namespace

const Effect& specimen_nonlinearity_effect();
const Effect& specimen_nonlinearity_effect() {
  static const SpecimenNonlinearity effect;
  return effect;
}

}  // namespace kolsky

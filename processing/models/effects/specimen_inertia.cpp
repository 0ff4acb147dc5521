#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class SpecimenInertia final : public Effect {
 public:
  SpecimenInertia()
      : Effect({
            .id = "specimen-inertia",
            .stage = Stage::specimen,
            .definition = "waves cross the specimen, of density s rho",
            .reference = "docs/methods/effects.md; Davies and Hunter 1963",
            .kinds = {BenchKind::shpb},
            .parameters =
                {{.name = "s", .unit = "-", .upper = 4.0, .typical = 0.2, .by_formula = 1.0}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->wave_density_kg_m3 = values[0] * scene.specimen->density_kg_m3;
  }
};

}  // namespace

const Effect& specimen_inertia_effect();
const Effect& specimen_inertia_effect() {
  static const SpecimenInertia effect;
  return effect;
}

}  // namespace kolsky

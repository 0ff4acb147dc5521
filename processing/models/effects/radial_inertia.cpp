#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"
#include "processing/models/times_formula.hpp"

namespace kolsky {
namespace {

class RadialInertia final : public Effect {
 public:
  RadialInertia()
      : Effect({
            .id = "radial-inertia",
            .stage = Stage::specimen,
            .definition = "stress += s (2 nu)^2 rho a^2 (strain''/8 + strain'^2/16)",
            .reference = "docs/methods/effects.md; Kolsky 1949, Samanta 1971",
            .kinds = {BenchKind::shpb},
            .parameters = {times_formula()},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    SpecimenScene& specimen = *scene.specimen;
    const double nu = specimen.poisson_ratio;
    specimen.lateral_inertia_kg_per_m = values[0] * 4.0 * nu * nu * specimen.density_kg_m3 *
                                        specimen.diameter_m * specimen.diameter_m / 4.0;
  }
};

}  // namespace

const Effect& radial_inertia_effect();
const Effect& radial_inertia_effect() {
  static const RadialInertia effect;
  return effect;
}

}  // namespace kolsky

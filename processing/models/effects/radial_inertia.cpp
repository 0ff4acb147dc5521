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
            .definition = "stress += s (2 nu)^2 rho a^2 (strain''/8 + strain'^2/16); strain''/8 is "
                          "the first term of waves across the section, or all of them",
            .reference = "docs/methods/effects.md; Kolsky 1949, Samanta 1971",
            .kinds = {BenchKind::shpb},
            // Of a wide or soft specimen the section is no small part of a wavelength.
            .parameters = {times_formula(),
                           {.name = "waves",
                            .unit = "-",
                            .upper = 1.0,
                            .typical = 1.0,
                            .starts = {0.0, 1.0},
                            .chosen = true,
                            .only_by_formula = true}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    SpecimenScene& specimen = *scene.specimen;
    const double nu = specimen.poisson_ratio;
    specimen.lateral_inertia_kg_per_m = values[0] * 4.0 * nu * nu * specimen.density_kg_m3 *
                                        specimen.diameter_m * specimen.diameter_m / 4.0;
    specimen.crossed_sideways = values[1] != 0.0;
  }
};

}  // namespace

const Effect& radial_inertia_effect();
const Effect& radial_inertia_effect() {
  static const RadialInertia effect;
  return effect;
}

}  // namespace kolsky

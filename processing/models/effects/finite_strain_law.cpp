#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class FiniteStrainLaw final : public Effect {
 public:
  FiniteStrainLaw()
      : Effect({
            .id = "finite-strain-law",
            .stage = Stage::specimen,
            .definition = "how the linear law meets finite strain: 0 Kirchhoff's stress, 1 "
                          "Cauchy's, from Hencky's strain",
            .reference = "docs/impact.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"s", "-", 0.0, -0.25, 1.25, 0.1, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->cauchy_share = values[0];
  }
};

}  // namespace

const Effect& finite_strain_law_effect();
const Effect& finite_strain_law_effect() {
  static const FiniteStrainLaw effect;
  return effect;
}

}  // namespace kolsky

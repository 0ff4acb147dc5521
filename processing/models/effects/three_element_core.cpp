#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class ThreeElementCore final : public Effect {
 public:
  ThreeElementCore()
      : Effect({
            .id = "three-element-core",
            .stage = Stage::specimen,
            .definition = "the ball's core: J = 1/E1 + 1/(E2 + s eta2), rho, nu",
            .reference = "paper, Table 3",
            .kinds = {BenchKind::impact},
            .parameters = {{"E1_Pa", "Pa", 1.21e8, 1e4, 1e13, 1e6, {}},
                           {"E2_Pa", "Pa", 1.43e8, 1e4, 1e14, 1e6, {}},
                           {"eta2_Pa_s", "Pa s", 2860.0, 1e-3, 1e12, 30.0, {}},
                           {"density_kg_m3", "kg/m3", 1140.0, 50.0, 2.5e4, 1.0, {}},
                           {"poisson_ratio", "-", 0.376, 0.0, 0.499, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    BallLayer& layer = scene.ball->core;
    layer.solid.E1_Pa = values[0];
    layer.solid.E2_Pa = values[1];
    layer.solid.eta2_Pa_s = values[2];
    layer.density_kg_m3 = values[3];
    layer.poisson_ratio = values[4];
  }
};

}  // namespace

const Effect& three_element_core_effect();
const Effect& three_element_core_effect() {
  static const ThreeElementCore effect;
  return effect;
}

}  // namespace kolsky

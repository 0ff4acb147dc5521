#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class ThreeElementSpecimen final : public Effect {
 public:
  ThreeElementSpecimen()
      : Effect({
            .id = "three-element-specimen",
            .stage = Stage::specimen,
            .definition = "J_s = 1/E1 + 1/(E2 + s eta2)",
            .reference = "paper, eq. 25",
            .kinds = {BenchKind::shpb},
            .parameters = {{"E1_Pa", "Pa", 1.0e8, 1e3, 1e13, 1e6, {}},
                           {"E2_Pa", "Pa", 1.0e8, 1e3, 1e14, 1e6, {}},
                           {"eta2_Pa_s", "Pa s", 3.0e3, 1e-6, 1e12, 30.0, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    Solid& solid = scene.specimen->solid;
    solid.E1_Pa = values[0];
    solid.E2_Pa = values[1];
    solid.eta2_Pa_s = values[2];
  }
};

}  // namespace

const Effect& three_element_specimen_effect();
const Effect& three_element_specimen_effect() {
  static const ThreeElementSpecimen effect;
  return effect;
}

}  // namespace kolsky

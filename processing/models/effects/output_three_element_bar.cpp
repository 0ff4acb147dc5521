#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class OutputThreeElementBar final : public Effect {
 public:
  OutputThreeElementBar()
      : Effect({
            .id = "output-three-element-bar",
            .stage = Stage::material,
            .definition = "J = 1/E1 + 1/(E2 + s eta2) of the output bar, where its moduli are not "
                          "those of three-element-bar",
            .reference = "paper, eq. A3",
            .kinds = {BenchKind::shpb},
            .parameters = {{"E1_Pa", "Pa", 5.66e9, 1e6, 1e12, 5e7, {}},
                           {"E2_Pa", "Pa", 37.0e9, 1e6, 1e14, 1e9, {}},
                           {"eta2_Pa_s", "Pa s", 1.81e6, 1e-3, 1e12, 5e4, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.size() > 1 && !scene.bars[1].elastic) {
      scene.bars[1].solid.E1_Pa = values[0];
      scene.bars[1].solid.E2_Pa = values[1];
      scene.bars[1].solid.eta2_Pa_s = values[2];
    }
  }
};

}  // namespace

const Effect& output_three_element_bar_effect();
const Effect& output_three_element_bar_effect() {
  static const OutputThreeElementBar effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class OutputBarModulus final : public Effect {
 public:
  OutputBarModulus()
      : Effect({
            .id = "output-bar-modulus",
            .stage = Stage::bench,
            .definition = "true modulus of an elastic output bar x (1 + delta), beside bar-modulus",
            .reference = "bench file",
            .kinds = {BenchKind::shpb},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.size() > 1 && scene.bars[1].elastic) {
      scene.bars[1].solid.E1_Pa *= 1.0 + values[0];
    }
  }
};

}  // namespace

const Effect& output_bar_modulus_effect();
const Effect& output_bar_modulus_effect() {
  static const OutputBarModulus effect;
  return effect;
}

}  // namespace kolsky

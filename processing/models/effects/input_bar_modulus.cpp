#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class InputBarModulus final : public Effect {
 public:
  InputBarModulus()
      : Effect({
            .id = "input-bar-modulus",
            .stage = Stage::bench,
            .definition = "true modulus of an elastic input bar x (1 + delta), beside bar-modulus",
            .reference = "bench file",
            .kinds = {BenchKind::shpb},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.front().elastic) {
      scene.bars.front().solid.E1_Pa *= 1.0 + values[0];
    }
  }
};

}  // namespace

const Effect& input_bar_modulus_effect();
const Effect& input_bar_modulus_effect() {
  static const InputBarModulus effect;
  return effect;
}

}  // namespace kolsky

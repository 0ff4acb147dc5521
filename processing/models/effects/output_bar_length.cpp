#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class OutputBarLength final : public Effect {
 public:
  OutputBarLength()
      : Effect({
            .id = "output-bar-length",
            .stage = Stage::bench,
            .definition = "true length of the output bar = filed + delta",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::shpb},
            .parameters = {{"delta", "m", 0.0, -0.2, 0.2, 1e-3, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.size() > 1) {
      scene.bars[1].length_m += values[0];
    }
  }
};

}  // namespace

const Effect& output_bar_length_effect();
const Effect& output_bar_length_effect() {
  static const OutputBarLength effect;
  return effect;
}

}  // namespace kolsky

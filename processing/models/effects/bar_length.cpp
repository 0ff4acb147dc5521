#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class BarLength final : public Effect {
 public:
  BarLength()
      : Effect({
            .id = "bar-length",
            .stage = Stage::bench,
            .definition = "true length = filed + delta",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"delta", "m", 0.0, -0.2, 0.2, 1e-3, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.bars.front().length_m += values[0];
  }
};

}  // namespace

const Effect& bar_length_effect();
const Effect& bar_length_effect() {
  static const BarLength effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class BarModulus final : public Effect {
 public:
  BarModulus()
      : Effect({
            .id = "bar-modulus",
            .stage = Stage::bench,
            .definition = "true modulus of elastic bars = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    for (BarScene& bar : scene.bars) {
      if (bar.elastic) {
        bar.solid.E1_Pa *= 1.0 + values[0];
      }
    }
  }
};

}  // namespace

const Effect& bar_modulus_effect();
const Effect& bar_modulus_effect() {
  static const BarModulus effect;
  return effect;
}

}  // namespace kolsky

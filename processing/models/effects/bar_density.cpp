#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class BarDensity final : public Effect {
 public:
  BarDensity()
      : Effect({
            .id = "bar-density",
            .stage = Stage::bench,
            .definition = "true density of the bar, of two the input bar, = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.bars.front().density_kg_m3 *= 1.0 + values[0];
  }
};

}  // namespace

const Effect& bar_density_effect();
const Effect& bar_density_effect() {
  static const BarDensity effect;
  return effect;
}

}  // namespace kolsky

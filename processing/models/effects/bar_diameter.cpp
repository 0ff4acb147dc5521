#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class BarDiameter final : public Effect {
 public:
  BarDiameter()
      : Effect({
            .id = "bar-diameter",
            .stage = Stage::bench,
            .definition = "true diameter of the bar, of two the input bar, = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::shpb, BenchKind::impact},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.bars.front().radius_m *= 1.0 + values[0];
    scene.bars.front().area_m2 *= (1.0 + values[0]) * (1.0 + values[0]);
  }
};

}  // namespace

const Effect& bar_diameter_effect();
const Effect& bar_diameter_effect() {
  static const BarDiameter effect;
  return effect;
}

}  // namespace kolsky

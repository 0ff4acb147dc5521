#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class OutputBarDiameter final : public Effect {
 public:
  OutputBarDiameter()
      : Effect({
            .id = "output-bar-diameter",
            .stage = Stage::bench,
            .definition = "true diameter of the output bar = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::shpb},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.size() > 1) {
      scene.bars[1].radius_m *= 1.0 + values[0];
      scene.bars[1].area_m2 *= (1.0 + values[0]) * (1.0 + values[0]);
    }
  }
};

}  // namespace

const Effect& output_bar_diameter_effect();
const Effect& output_bar_diameter_effect() {
  static const OutputBarDiameter effect;
  return effect;
}

}  // namespace kolsky

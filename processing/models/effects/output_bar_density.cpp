#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class OutputBarDensity final : public Effect {
 public:
  OutputBarDensity()
      : Effect({
            .id = "output-bar-density",
            .stage = Stage::bench,
            .definition = "true density of the output bar = filed x (1 + delta)",
            .reference = "bench file",
            .kinds = {BenchKind::shpb},
            .parameters = {{"delta", "-", 0.0, -0.3, 0.3, 1e-3, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.size() > 1) {
      scene.bars[1].density_kg_m3 *= 1.0 + values[0];
    }
  }
};

}  // namespace

const Effect& output_bar_density_effect();
const Effect& output_bar_density_effect() {
  static const OutputBarDensity effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class GaugePosition final : public Effect {
 public:
  GaugePosition()
      : Effect({
            .id = "gauge-position",
            .stage = Stage::bench,
            .definition = "true x = filed x + delta",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"delta", "m", 0.0, -0.2, 0.2, 1e-3, {}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    scene.gauges[gauge].position_m += values[0];
  }
};

}  // namespace

const Effect& gauge_position_effect();
const Effect& gauge_position_effect() {
  static const GaugePosition effect;
  return effect;
}

}  // namespace kolsky

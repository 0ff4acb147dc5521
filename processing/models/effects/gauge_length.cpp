#include <cmath>

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class GaugeLength final : public Effect {
 public:
  GaugeLength()
      : Effect({
            .id = "gauge-length",
            .stage = Stage::sensor,
            .definition = "reading x sinh(gamma L/2) / (gamma L/2)",
            .reference = "effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"L", "m", 0.0, 0.0, 0.5, 5e-3, {}, false, 2e-3, false, 2.0}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    GaugeScene& g = scene.gauges[gauge];
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      const Complex half = scene.bars[g.bar].gamma_per_m[k] * values[0] / 2.0;
      g.factor[k] *= std::abs(half) < 1e-3 ? 1.0 + half * half / 6.0 : std::sinh(half) / half;
    }
  }
};

}  // namespace

const Effect& gauge_length_effect();
const Effect& gauge_length_effect() {
  static const GaugeLength effect;
  return effect;
}

}  // namespace kolsky

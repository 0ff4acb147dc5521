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
            .definition = "reading x sinh(gamma L/2) / (gamma L/2), beside the length filed",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"L", "m", 0.0, 0.0, 0.5, 5e-3, {}, false, 2e-3, false, 2.0, 0.1}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    // A mean of a mean is, but for the fourth order, one over the root of both squares.
    double& length_m = scene.gauges[gauge].length_m;
    length_m = std::hypot(length_m, values[0]);
  }
};

}  // namespace

const Effect& gauge_length_effect();
const Effect& gauge_length_effect() {
  static const GaugeLength effect;
  return effect;
}

}  // namespace kolsky

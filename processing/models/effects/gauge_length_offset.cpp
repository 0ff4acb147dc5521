#include <algorithm>

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

/// Where a deviation of the length is filed. Beside it `gauge-length` only makes a gauge longer,
/// and not at all at first order.
class GaugeLengthOffset final : public Effect {
 public:
  GaugeLengthOffset()
      : Effect({
            .id = "gauge-length-offset",
            .stage = Stage::bench,
            .definition = "true L = filed L + delta",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"delta", "m", 0.0, -0.2, 0.2, 1e-3, {}}},
            .per_gauge = true,
            .told_only = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    double& length_m = scene.gauges[gauge].length_m;
    length_m = std::max(0.0, length_m + values[0]);
  }
};

}  // namespace

const Effect& gauge_length_offset_effect();
const Effect& gauge_length_offset_effect() {
  static const GaugeLengthOffset effect;
  return effect;
}

}  // namespace kolsky

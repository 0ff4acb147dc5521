#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class BridgeNonlinearity final : public Effect {
 public:
  BridgeNonlinearity()
      : Effect({
            .id = "bridge-nonlinearity",
            .stage = Stage::record,
            .definition = "reading = e (1 + b e)",
            .reference = "docs/methods/effects.md; Vishay TN-507",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {strength()},
        }) {}

  /// A raw quarter bridge has half its gauge factor, of semiconductors up to 90, whatever the
  /// strain; what follows the gauges bends by a share of what it is built to read.
  static EffectParameter strength() {
    EffectParameter b{"b", "-", 0.0, -500.0, 500.0, 0.5, {}};
    b.most = 100.0;
    b.most_times_peak = 0.1;
    return b;
  }

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.record.bridge_b = values[0];
  }
};

}  // namespace

const Effect& bridge_nonlinearity_effect();
const Effect& bridge_nonlinearity_effect() {
  static const BridgeNonlinearity effect;
  return effect;
}

}  // namespace kolsky

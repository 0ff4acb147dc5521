#include <cmath>

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class ChannelDelay final : public Effect {
 public:
  ChannelDelay()
      : Effect({
            .id = "channel-delay",
            .stage = Stage::sensor,
            .definition = "reading x exp(-s tau), late positive",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"tau", "s", 0.0, -2e-5, 2e-5, 2e-7, {}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      scene.gauges[gauge].factor[k] *= std::exp(-scene.s[k] * values[0]);
    }
  }
};

}  // namespace

const Effect& channel_delay_effect();
const Effect& channel_delay_effect() {
  static const ChannelDelay effect;
  return effect;
}

}  // namespace kolsky

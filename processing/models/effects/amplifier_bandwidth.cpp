#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class AmplifierBandwidth final : public Effect {
 public:
  AmplifierBandwidth()
      : Effect({
            .id = "amplifier-bandwidth",
            .stage = Stage::sensor,
            .definition = "reading / (1 + s tau), tau = 1/(2 pi fc)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"tau", "s", 0.0, 0.0, 1e-4, 5e-7, {}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      scene.gauges[gauge].factor[k] /= 1.0 + scene.s[k] * values[0];
    }
  }
};

}  // namespace

const Effect& amplifier_bandwidth_effect();
const Effect& amplifier_bandwidth_effect() {
  static const AmplifierBandwidth effect;
  return effect;
}

}  // namespace kolsky

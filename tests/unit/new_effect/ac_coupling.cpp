#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

/// An amplifier that is coupled by a capacitor loses what is slower than its time constant.
class AcCoupling final : public Effect {
 public:
  AcCoupling()
      : Effect({
            .id = "ac-coupling",
            .stage = Stage::sensor,
            .definition = "reading x s / (s + r), r = 1/(R C)",
            .reference = "docs/methods/new-effect.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"r", "1/s", 0.0, 0.0, 1e4, 10.0, {}}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      scene.gauges[gauge].factor[k] *= scene.s[k] / (scene.s[k] + values[0]);
    }
  }
};

}  // namespace

const Effect& ac_coupling_effect();
const Effect& ac_coupling_effect() {
  static const AcCoupling effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class Crosstalk final : public Effect {
 public:
  Crosstalk()
      : Effect({
            .id = "crosstalk",
            .stage = Stage::sensor,
            .definition = "reading += kappa x its neighbour's",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"kappa", "-", 0.0, -0.5, 0.5, 5e-3, {}},
                           {"neighbour", "-", 0.0, -1.0, 1.0, 1.0, {-1.0, 1.0}, false, 2e-3, true}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    // The channel before or after it in the bench's list; the first and the last have one.
    const std::size_t last = scene.gauges.size() - 1;
    if (last == 0) {
      return;
    }
    const bool before = gauge == last || (gauge > 0 && values[1] < 0.0);
    scene.gauges[gauge].picks_up.emplace_back(before ? gauge - 1 : gauge + 1, values[0]);
  }
};

}  // namespace

const Effect& crosstalk_effect();
const Effect& crosstalk_effect() {
  static const Crosstalk effect;
  return effect;
}

}  // namespace kolsky

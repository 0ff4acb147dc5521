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
            .reference = "effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"kappa", "-", 0.0, -0.5, 0.5, 5e-3, {}},
                           {"neighbour", "-", 0.0, -1.0, 1.0, 1.0, {-1.0, 1.0}, false, 2e-3, true}},
            .per_gauge = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t gauge) const override {
    // The channel before or after it in the bench's list.
    const auto count = static_cast<std::ptrdiff_t>(scene.gauges.size());
    const std::ptrdiff_t other = static_cast<std::ptrdiff_t>(gauge) + (values[1] < 0.0 ? -1 : 1);
    if (other >= 0 && other < count) {
      scene.gauges[gauge].picks_up.emplace_back(static_cast<std::size_t>(other), values[0]);
    }
  }
};

}  // namespace

const Effect& crosstalk_effect();
const Effect& crosstalk_effect() {
  static const Crosstalk effect;
  return effect;
}

}  // namespace kolsky

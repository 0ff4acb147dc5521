#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class SeriesDashpot final : public Effect {
 public:
  SeriesDashpot()
      : Effect({
            .id = "series-dashpot",
            .stage = Stage::material,
            .definition = "J += phi / s",
            .reference = "docs/methods/effects.md; Burgers' fluid",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"phi", "1/(Pa s)", 0.0, 0.0, 1e-2, 1e-9, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    for (BarScene& bar : scene.bars) {
      bar.solid.phi_per_Pa_s += values[0];
    }
  }
};

}  // namespace

const Effect& series_dashpot_effect();
const Effect& series_dashpot_effect() {
  static const SeriesDashpot effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"
#include "processing/models/softening.hpp"

namespace kolsky {
namespace {

class BarTemperature final : public Effect {
 public:
  BarTemperature()
      : Effect({
            .id = "bar-temperature",
            .stage = Stage::material,
            .definition = "viscoelastic bars were dT warmer in a shot than is filed or logged: "
                          "E1, E2 x (1 - 0.003 dT)",
            .reference = "bench file; docs/methods/uncertainty.md",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"dT", "K", 0.0, -30.0, 30.0, 0.1, {}}},
            .per_shot = true,
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    for (BarScene& bar : scene.bars) {
      if (!bar.elastic) {
        bar.solid.E1_Pa *= 1.0 - kSofteningPerK * values[0];
        bar.solid.E2_Pa *= 1.0 - kSofteningPerK * values[0];
      }
    }
  }
};

}  // namespace

const Effect& bar_temperature_effect();
const Effect& bar_temperature_effect() {
  static const BarTemperature effect;
  return effect;
}

}  // namespace kolsky

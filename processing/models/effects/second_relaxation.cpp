#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class SecondRelaxation final : public Effect {
 public:
  SecondRelaxation()
      : Effect({
            .id = "second-relaxation",
            .stage = Stage::material,
            .definition = "J += D / (1 + s tau)",
            .reference = "docs/methods/effects.md; Ferry 1980",
            .kinds = {BenchKind::bar, BenchKind::shpb},
            .parameters = {{"D", "1/Pa", 0.0, 0.0, 1e-6, 1e-12, {}},
                           {"tau",
                            "s",
                            0.0,
                            2e-7,
                            1e-1,
                            1e-5,
                            {2e-6, 5e-6, 1.2e-5, 3e-5, 8e-5, 2e-4, 6e-4, 2e-3}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    for (BarScene& bar : scene.bars) {
      bar.solid.relaxations.push_back({values[0], values[1]});
    }
  }
};

}  // namespace

const Effect& second_relaxation_effect();
const Effect& second_relaxation_effect() {
  static const SecondRelaxation effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"
#include "processing/models/transfers.hpp"

namespace kolsky {
namespace {

class ElementaryWaves final : public Effect {
 public:
  ElementaryWaves()
      : Effect({
            .id = "elementary-waves",
            .stage = Stage::propagation,
            .definition = "gamma = s sqrt(rho J)",
            .reference = "paper, eq. 6",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> /*values*/,
             std::size_t /*gauge*/) const override {
    set_elementary_waves(scene);
  }
};

}  // namespace

const Effect& elementary_waves_effect();
const Effect& elementary_waves_effect() {
  static const ElementaryWaves effect;
  return effect;
}

}  // namespace kolsky

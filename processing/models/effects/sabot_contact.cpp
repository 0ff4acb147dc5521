#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class SabotContact final : public Effect {
 public:
  SabotContact()
      : Effect({
            .id = "sabot-contact",
            .stage = Stage::boundary,
            .definition =
                "a rigid mass m follows at the speed of incidence and touches the rear pole",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"m", "kg", 0.0, 0.0, 0.5, 1e-3, {}, false, 0.5}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->sabot_mass_kg = values[0];
  }
};

}  // namespace

const Effect& sabot_contact_effect();
const Effect& sabot_contact_effect() {
  static const SabotContact effect;
  return effect;
}

}  // namespace kolsky

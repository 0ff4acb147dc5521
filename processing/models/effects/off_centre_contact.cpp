#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class OffCentreContact final : public Effect {
 public:
  OffCentreContact()
      : Effect({
            .id = "off-centre-contact",
            .stage = Stage::boundary,
            .definition =
                "the ball's axis off the bar's by delta: what overhangs yields, an estimate",
            .reference = "docs/methods/effects.md; docs/impact.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"delta", "m", 0.0, 0.0, 0.01, 1e-3, {}, false, 1.0}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->offset_m = values[0];
  }
};

}  // namespace

const Effect& off_centre_contact_effect();
const Effect& off_centre_contact_effect() {
  static const OffCentreContact effect;
  return effect;
}

}  // namespace kolsky

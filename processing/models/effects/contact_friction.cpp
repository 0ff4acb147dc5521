#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class ContactFriction final : public Effect {
 public:
  ContactFriction()
      : Effect({
            .id = "contact-friction",
            .stage = Stage::boundary,
            .definition = "Coulomb friction between ball and bar",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"mu", "-", 0.0, 0.0, 2.0, 0.1, {}, false, 0.02}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->friction = values[0];
  }
};

}  // namespace

const Effect& contact_friction_effect();
const Effect& contact_friction_effect() {
  static const ContactFriction effect;
  return effect;
}

}  // namespace kolsky

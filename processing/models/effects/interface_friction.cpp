#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class InterfaceFriction final : public Effect {
 public:
  InterfaceFriction()
      : Effect({
            .id = "interface-friction",
            .stage = Stage::specimen,
            .definition = "stress measured = stress (1 + mu d/3h), current d and h",
            .reference = "docs/methods/effects.md; Siebel 1923",
            .kinds = {BenchKind::shpb},
            .parameters = {{"mu", "-", 0.0, 0.0, 1.0, 0.02, {}}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->friction = values[0];
  }
};

}  // namespace

const Effect& interface_friction_effect();
const Effect& interface_friction_effect() {
  static const InterfaceFriction effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class EndReflection final : public Effect {
 public:
  EndReflection()
      : Effect({
            .id = "end-reflection",
            .stage = Stage::boundary,
            .definition = "the far end sends waves back, stress x (-1 + r)",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::impact},
            .parameters = {{"present", "-", 0.0, 0.0, 1.0, 0.02, {}, true},
                           {"r", "-", 0.0, 0.0, 2.0, 0.02, {0.0, 2.0}}},
            .strength = 1,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.bars.front().far_reflection = values[0] * (-1.0 + values[1]);
  }
};

}  // namespace

const Effect& end_reflection_effect();
const Effect& end_reflection_effect() {
  static const EndReflection effect;
  return effect;
}

}  // namespace kolsky

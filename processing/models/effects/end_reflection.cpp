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
            .definition =
                "the far end sends waves back, stress x (-1 + r); of split bars the output "
                "bar's, which is free else",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::bar, BenchKind::shpb, BenchKind::impact},
            .parameters = {{"present", "-", 0.0, 0.0, 1.0, 0.02, {}, true},
                           {"r", "-", 0.0, 0.0, 2.0, 0.02, {0.0, 2.0}}},
            .strength = 1,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    if (scene.bars.size() == 1) {
      scene.bars.front().far_reflection = values[0] * (-1.0 + values[1]);
    } else {
      scene.bars.back().far_reflection = -1.0 + values[0] * values[1];
    }
  }

  [[nodiscard]] std::string untestable_because(const Bench& bench) const override {
    return bench.output && bench.output->far_end == FarEnd::matched
               ? "the output bar's far end is filed as matched"
               : "";
  }
};

}  // namespace

const Effect& end_reflection_effect();
const Effect& end_reflection_effect() {
  static const EndReflection effect;
  return effect;
}

}  // namespace kolsky

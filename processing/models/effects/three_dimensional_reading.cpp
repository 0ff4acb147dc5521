#include <cmath>

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class ThreeDimensionalReading final : public Effect {
 public:
  ThreeDimensionalReading()
      : Effect({
            .id = "three-dimensional-reading",
            .stage = Stage::specimen,
            .definition = "what bulk and shear make of the uniaxial law: 0 full, 1 bulk-E1, 2 "
                          "bulk-Einf, 3 exact",
            .reference = "docs/impact.md",
            .kinds = {BenchKind::impact},
            .parameters = {{"reading", "-", 0.0, 0.0, 3.0, 1.0, {}}},
            .base = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.ball->reading = static_cast<int>(std::lround(values[0]));
  }
};

}  // namespace

const Effect& three_dimensional_reading_effect();
const Effect& three_dimensional_reading_effect() {
  static const ThreeDimensionalReading effect;
  return effect;
}

}  // namespace kolsky

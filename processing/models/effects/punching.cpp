#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"
#include "processing/models/times_formula.hpp"

namespace kolsky {
namespace {

class Punching final : public Effect {
 public:
  Punching()
      : Effect({
            .id = "punching",
            .stage = Stage::specimen,
            .definition = "shortening += s sum over faces of k F (1 - nu^2) J_bar / d_s",
            .reference = "docs/methods/effects.md; Safa and Gary 2010",
            .kinds = {BenchKind::shpb},
            .parameters = {times_formula()},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->punching = values[0];
  }
};

}  // namespace

const Effect& punching_effect();
const Effect& punching_effect() {
  static const Punching effect;
  return effect;
}

}  // namespace kolsky

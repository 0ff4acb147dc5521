#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

/// A specimen that lies loose between the bars is pushed and never pulled.
class PartingFaces final : public Effect {
 public:
  PartingFaces()
      : Effect({
            .id = "parting-faces",
            .stage = Stage::specimen,
            .definition = "faces part wherever the specimen would be pulled, and it recovers",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::shpb},
            .parameters =
                {{.name = "present", .unit = "-", .upper = 1.0, .typical = 1.0, .is_switch = true}},
            .told_only = true,
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->parts = values[0] > 0.5;
  }
};

}  // namespace

const Effect& parting_faces_effect();
const Effect& parting_faces_effect() {
  static const PartingFaces effect;
  return effect;
}

}  // namespace kolsky

#include "processing/models/effect.hpp"
#include "processing/models/scene.hpp"

namespace kolsky {
namespace {

class InterfaceGap final : public Effect {
 public:
  InterfaceGap()
      : Effect({
            .id = "interface-gap",
            .stage = Stage::specimen,
            .definition = "a gap or soft layer closes before the specimen is loaded",
            .reference = "docs/methods/effects.md",
            .kinds = {BenchKind::shpb},
            // Reopens: 0 closed for good, 1 where it was, 2 wherever it would be pulled.
            // A gap below the noise of the strain before the pulse shows nothing of what one does.
            .parameters =
                {{"delta", "m", 0.0, 0.0, 1e-3, 5e-6, {}, false, 1.0, false, 1.0, 0.0, 0.0, true},
                 {"reopens", "-", 0.0, 0.0, 2.0, 1.0, {0.0, 1.0, 2.0}, false, 2e-3, true}},
        }) {}

  void apply(Scene& scene, std::span<const double> values, std::size_t /*gauge*/) const override {
    scene.specimen->gap_m = values[0];
    scene.specimen->gap_after = values[1] > 1.5   ? GapAfter::pulls_nothing
                                : values[1] > 0.5 ? GapAfter::opens_where_it_was
                                                  : GapAfter::closed_for_good;
  }
};

}  // namespace

const Effect& interface_gap_effect();
const Effect& interface_gap_effect() {
  static const InterfaceGap effect;
  return effect;
}

}  // namespace kolsky

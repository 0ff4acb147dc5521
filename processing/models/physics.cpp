#include "processing/models/physics.hpp"

namespace kolsky {

void shape(const std::vector<AppliedEffect>& effects, Scene& scene) {
  for (const Stage stage : {Stage::bench, Stage::material, Stage::propagation, Stage::boundary,
                            Stage::specimen, Stage::sensor, Stage::record}) {
    for (const AppliedEffect& use : effects) {
      if (use.effect->about().stage == stage) {
        use.effect->apply(scene, use.values, use.gauge);
      }
    }
  }
}

}  // namespace kolsky

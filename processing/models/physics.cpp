#include "processing/models/physics.hpp"

namespace kolsky {

void shape(const std::vector<AppliedEffect>& effects, Scene& scene) {
  for (const Stage stage : {Stage::bench, Stage::material, Stage::propagation, Stage::boundary,
                            Stage::specimen, Stage::sensor, Stage::record}) {
    // What the paper's model consists of comes before what corrects it, wherever a file has it.
    for (const bool base : {true, false}) {
      for (const AppliedEffect& use : effects) {
        const EffectAbout& about = use.effect->about();
        if (about.stage == stage && about.base == base) {
          use.effect->apply(scene, use.values, use.gauge);
        }
      }
    }
  }
}

}  // namespace kolsky

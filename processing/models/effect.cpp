#include "processing/models/effect.hpp"

#include <algorithm>

namespace kolsky {

std::string name_of(Stage stage) {
  switch (stage) {
    case Stage::bench:
      return "bench";
    case Stage::material:
      return "material";
    case Stage::propagation:
      return "propagation";
    case Stage::boundary:
      return "boundary";
    case Stage::specimen:
      return "specimen";
    case Stage::sensor:
      return "sensor";
    case Stage::record:
      return "record";
  }
  return {};
}

const Effect* find_effect(const std::string& id) {
  const auto& all = effect_library();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Effect* effect) { return effect->about().id == id; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace kolsky

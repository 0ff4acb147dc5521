#include "processing/criticism/search/safeguards.hpp"

namespace kolsky {

const std::vector<NamedSafeguard>& named_safeguards() {
  static const std::vector<NamedSafeguard> list{
      {"search-count", "the chance of a gain counts how many effects were tried",
       &Safeguards::search_count},
      {"held-out", "an effect foretells most shots that the fit did not see",
       &Safeguards::held_out},
      {"shot-agreement", "an effect is as strong in every shot", &Safeguards::shot_agreement},
      {"own-strengths", "drifts and hums of single shots are confirmed otherwise",
       &Safeguards::own_strengths},
      {"fitted-noise", "what does not repeat is noise, not the quiet part alone",
       &Safeguards::fitted_noise},
      {"slow-noise", "what is claimed is more than slow noise that hangs together",
       &Safeguards::slow_noise},
      {"backward", "what was found first is sought again beside the rest", &Safeguards::backward},
      {"unknown", "where misfit remains that nothing explains, nothing is named",
       &Safeguards::unknown}};
  return list;
}

std::vector<std::string> left_out(const Safeguards& safeguards) {
  std::vector<std::string> names;
  for (const NamedSafeguard& one : named_safeguards()) {
    if (!(safeguards.*one.member)) {
      names.push_back(one.name);
    }
  }
  return names;
}

}  // namespace kolsky

#include "processing/criticism/impact/next_impact.hpp"

#include <algorithm>

namespace kolsky {

NextExperiment next_impact(const std::vector<std::string>& tied) {
  const auto holds = [&](const char* word) {
    return std::ranges::any_of(
        tied, [&](const std::string& id) { return id.find(word) != std::string::npos; });
  };
  NextExperiment next;
  next.separates = tied;
  if (holds("bridge") || holds("gauge-factor") || holds("amplifier") || holds("crosstalk")) {
    next.change =
        "a shunt or a striker of known momentum on the same gauges at the same strain: it shows "
        "the bridge without the ball";
  } else if (holds("off-centre") || holds("sabot") || holds("friction")) {
    next.change =
        "a photograph of the contact, and rebound speeds: they show what touches without the "
        "material";
  } else {
    next.change =
        "the materials alone on the Hopkinson bar at larger strain, and impacts at 15 to 20 m/s "
        "with rebound speeds";
  }
  return next;
}

}  // namespace kolsky

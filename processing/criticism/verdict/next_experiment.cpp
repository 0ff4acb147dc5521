#include "processing/criticism/verdict/next_experiment.hpp"

#include <algorithm>

namespace kolsky {

namespace {

bool about(const std::vector<std::string>& ids, const std::string& word) {
  return std::any_of(ids.begin(), ids.end(),
                     [&](const std::string& id) { return id.find(word) != std::string::npos; });
}

}  // namespace

NextExperiment next_experiment(const std::string& effect, const std::vector<std::string>& ties,
                               const Bench& bench) {
  std::vector<std::string> all = ties;
  all.insert(all.begin(), effect);
  NextExperiment next;
  next.separates = all;
  const bool per_gauge = std::all_of(all.begin(), all.end(), [](const std::string& id) {
    return id.find(':') != std::string::npos;
  });
  const bool sensors = about(all, "gauge-factor") || about(all, "gauge-position") ||
                       about(all, "channel-delay") || about(all, "amplifier") ||
                       about(all, "gauge-length") || about(all, "crosstalk");
  const bool in_time = std::all_of(all.begin(), all.end(), [](const std::string& id) {
    return id.starts_with("channel-delay") || id.starts_with("amplifier");
  });
  next.change = "a shorter striker, for higher frequencies";
  if (in_time) {
    return next;  // alike to first order in frequency, and only so
  }
  if (about(all, "amplitude") || about(all, "nonlinear")) {
    next.change = "a series of amplitudes, from a third to three times today's";
  } else if (about(all, "temperature")) {
    next.change = "log the temperature of each shot, over at least 5 K";
  } else if (about(all, "drift") || about(all, "hum")) {
    next.change = "a pre-trigger of at least 20 ms";
  } else if (per_gauge && sensors && bench.gauges.size() < 4) {
    next.change = "a further gauge between those there are, and the channels swapped for one shot";
  } else if (sensors) {
    next.change = "the channels of the gauges concerned swapped for some shots";
  } else if (about(all, "second-relaxation") && about(all, "dashpot")) {
    // A relaxation slower than the pulse flows like a dashpot until it has relaxed.
    next.change =
        "a further gauge at a larger distance, and a longer striker, for lower frequencies";
  } else if (about(all, "relaxation") || about(all, "dashpot") || about(all, "fractional")) {
    next.change = "a further gauge at a larger distance, and a shorter striker";
  }
  return next;
}

}  // namespace kolsky

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/simulated/bench_model.hpp"

namespace kolsky {

/// What a campaign hides. Ids, parameters and units are those that models of the library use; an
/// effect that the library does not hold has a name of its own.
struct HiddenTruth {
  std::string id;  ///< empty: nothing is hidden
  std::string parameter;
  std::string unit;
  double strength = 0.0;
  std::string words;  ///< what it is, for people
  bool in_library = true;
  std::size_t gauge = 0;  ///< of effects of one gauge
  double tau_s = 0.0;     ///< of effects with a time of their own
};

/// One shot's circumstances.
struct HiddenShot {
  ImpactPulse pulse;
  double striker_speed_m_per_s = 0.0;
  double temperature_K = 0.0;
  double fraction = 0.0;  ///< of a sample, between the impact and the converter's clock
};

/// A bar with gauges, struck again and again, and one thing about it that its bench file does not
/// say. Everything is drawn from a seed.
struct HiddenCampaign {
  std::uint64_t seed = 0;
  HiddenTruth truth;
  RodMaterial material;
  double length_m = 0.0;
  double diameter_m = 0.0;
  double density_kg_m3 = 0.0;
  double temperature_K = 0.0;
  std::vector<double> filed_position_m;
  std::vector<double> true_position_m;
  std::vector<double> gain;  ///< true reading over what the bench file says
  double noise_microstrain = 0.0;
  double sample_rate_Hz = 0.0;
  std::size_t samples = 0;
  std::size_t pre_samples = 0;
  std::vector<HiddenShot> shots;
};

/// Draws a campaign: bar of a PMMA near the paper's, gauges, pulses, temperatures, errors of gauges
/// within what the bench file admits, and what is hidden: an effect of the library, one that is in
/// no library, or nothing.
[[nodiscard]] HiddenCampaign draw_hidden_campaign(std::uint64_t seed, std::size_t shots);

/// The bench file, which says nothing of what is hidden.
[[nodiscard]] std::string bench_toml(const HiddenCampaign& campaign);

/// What the converter reads in one shot, as a table with a column per gauge in volts. The rod is
/// stepped through time on a grid; no transform occurs, and nothing of the code that analyses it.
/// @param steps_per_second  of the rod
[[nodiscard]] std::string shot_table(const HiddenCampaign& campaign, std::size_t shot,
                                     double steps_per_second = 8e6);

}  // namespace kolsky

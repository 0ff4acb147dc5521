#include "tests/generators/bar_campaign.hpp"

#include <fmt/format.h>

#include "processing/base/error.hpp"
#include "tests/generators/digitise.hpp"

namespace kolsky::testing {

void hide(BarCampaign& campaign, const HiddenEffect& effect) {
  plant(campaign.world, effect);
  campaign.effects.push_back(effect);
}

std::vector<Shot> shots_of(const BarCampaign& campaign, const Readings& readings) {
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    const TrueShot& truth = campaign.world.shots[i];
    Digitiser digitiser;
    digitiser.noise_strain = campaign.wishes.noise_strain;
    digitiser.colour = campaign.wishes.colour;
    digitiser.measured_noise = campaign.wishes.measured_noise;
    digitiser.bits = campaign.bits;
    digitiser.full_scale_strain = campaign.full_scale_strain;
    digitiser.pretrigger = campaign.world.timing.pretrigger;
    digitiser.seed = campaign.wishes.seed * 1000003u + i;
    shots.push_back(
        digitised(campaign.bench, readings[i], truth.offset, digitiser,
                  {{"temperature_K", fmt::format("{:.2f}", truth.temperature_K)},
                   {"striker_speed_m_per_s", fmt::format("{:.2f}", truth.striker_speed_m_per_s)}}));
  }
  return shots;
}

std::vector<Shot> shots_of(const BarCampaign& campaign) {
  BarForward forward;
  return shots_of(campaign, forward.readings(campaign.world));
}

NoiseColour colour_named(const std::string& name) {
  if (name == "white") {
    return NoiseColour::white;
  }
  if (name == "coloured") {
    return NoiseColour::coloured;
  }
  if (name == "pink") {
    return NoiseColour::pink;
  }
  if (name == "measured") {
    return NoiseColour::measured;
  }
  throw InputError("--noise-colour", "\"" + name + "\" is no colour of noise",
                   "write white, coloured, pink or measured");
}

}  // namespace kolsky::testing

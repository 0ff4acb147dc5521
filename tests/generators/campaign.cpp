#include "tests/generators/campaign.hpp"

#include <fmt/format.h>

#include "tests/generators/digitise.hpp"

namespace kolsky::testing {

void hide(Campaign& campaign, const HiddenEffect& effect) {
  if (campaign.split) {
    ShpbWorld whole = split_world(campaign);
    plant(whole, effect);
    campaign.world = whole.base;
    campaign.split = SplitParts{whole.output_length_m, whole.specimen};
  } else {
    plant(campaign.world, effect);
  }
  campaign.effects.push_back(effect);
}

std::vector<Shot> shots_of(const Campaign& campaign, const Readings& readings) {
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

std::vector<Shot> shots_of(const Campaign& campaign) {
  CampaignForward forward;
  return shots_of(campaign, forward.readings(campaign));
}

Readings CampaignForward::readings(const Campaign& campaign) {
  return campaign.split ? split_.readings(split_world(campaign)) : bar_.readings(campaign.world);
}

std::vector<std::vector<double>> CampaignForward::bell_records(const Campaign& campaign,
                                                               std::size_t samples) {
  const Timing& timing = campaign.world.timing;
  if (campaign.split) {
    ShpbWorld world = split_world(campaign);
    world.base.timing.lead_s = 0.0;
    world.base.timing.samples = samples;
    world.base.shots.resize(1);
    // Large enough for the contact's tolerance, small enough to stay a matter of size.
    constexpr double kBell_Pa = 1e6;
    world.base.shots[0].source = {kBell_Pa};
    std::vector<std::vector<double>> records = shpb_readings(world)[0];
    for (std::vector<double>& record : records) {
      for (double& value : record) {
        value /= kBell_Pa;
      }
    }
    return records;
  }
  const Responses responses = bar_.sensor_responses(campaign.world, campaign.world.shots.front());
  std::vector<std::vector<double>> records;
  for (std::size_t g = 0; g < responses.strain.size(); ++g) {
    records.push_back(superpose(responses.strain[g], responses.step_s, std::vector<double>{1.0}, 1,
                                timing.period_s(), 0.0, samples));
    for (double& value : records.back()) {
      value *= campaign.world.gauges[g].gain;
    }
  }
  return records;
}

}  // namespace kolsky::testing

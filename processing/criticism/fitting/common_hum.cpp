#include "processing/criticism/fitting/common_hum.hpp"

#include "processing/criticism/fitting/composition.hpp"
#include "processing/criticism/fitting/quiet_slopes.hpp"

namespace kolsky {

std::optional<Model> beside_common_hum(const Model& model, const Campaign& campaign) {
  constexpr const char* kHum = "mains-hum";
  constexpr double kNoNoise = -9.2;  // ln of one in ten thousand
  if (model.find(kHum) != nullptr || log_chance_of_common_slopes(campaign) > kNoNoise) {
    return std::nullopt;
  }
  Model beside = all_but_own_held(model, campaign.bench);
  EffectUse hum = use_named(kHum);
  hum.per_shot = true;
  hum.alike = true;
  const auto& parameters = hum.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    constexpr double kLargest = 30.0;  // typical sizes: a free source takes up most of it
    hum.values[p].free = !parameters[p].auxiliary();
    hum.values[p].prior_sd = hum.values[p].free ? kLargest * parameters[p].typical : 0.0;
  }
  beside.effects.push_back(std::move(hum));
  return beside;
}

}  // namespace kolsky

#include "tests/generators/truth_file.hpp"

namespace kolsky::testing {

namespace {

nlohmann::json of_effect(const HiddenEffect& effect) {
  nlohmann::json json{{"effect", effect.name()}, {"strength", effect.strength}};
  for (const auto& [key, value] : effect.details) {
    json[key] = value;
  }
  return json;
}

nlohmann::json of_material(const TrueMaterial& material) {
  return {{"E1_Pa", material.E1_Pa},
          {"E2_Pa", material.E2_Pa},
          {"eta2_Pa_s", material.eta2_Pa_s},
          {"elastic", material.elastic},
          {"density_kg_m3", material.density_kg_m3},
          {"poisson_ratio", material.poisson_ratio},
          {"relaxation_per_Pa", material.relaxation_per_Pa},
          {"relaxation_time_s", material.relaxation_time_s},
          {"fluidity_per_Pa_s", material.fluidity_per_Pa_s},
          {"beta", material.beta},
          {"per_kelvin", material.per_kelvin},
          {"per_peak_strain", material.per_peak_strain}};
}

nlohmann::json of_gauge(const TrueGauge& gauge) {
  return {{"name", gauge.name},
          {"bar", gauge.bar},
          {"position_m", gauge.position_m},
          {"reading_over_filed", gauge.gain},
          {"length_m", gauge.length_m},
          {"delay_s", gauge.delay_s},
          {"amplifier_tau_s", gauge.amplifier_tau_s},
          {"drift_per_s", gauge.drift_per_s},
          {"crosstalk", gauge.crosstalk}};
}

nlohmann::json of_shot(const TrueShot& shot) {
  return {{"peak_strain", shot.peak_strain},
          {"temperature_K", shot.temperature_K},
          {"offset_strain", shot.offset}};
}

template <typename T, typename Make>
nlohmann::json list(const std::vector<T>& items, const Make& make) {
  nlohmann::json json = nlohmann::json::array();
  for (const T& item : items) {
    json.push_back(make(item));
  }
  return json;
}

}  // namespace

nlohmann::json truth_of(const Campaign& campaign) {
  const BarWorld& world = campaign.world;
  nlohmann::json json{{"kind", campaign.split ? "shpb" : "bar"},
                      {"seed", campaign.wishes.seed},
                      {"effects", list(campaign.effects, of_effect)},
                      {"noise_strain", campaign.wishes.noise_strain},
                      {"noise_colour", name_of(campaign.wishes.colour)},
                      {"bits", campaign.bits},
                      {"full_scale_strain", campaign.full_scale_strain},
                      {"material", of_material(world.material)},
                      {"radius_m", world.radius_m},
                      {"length_m", world.length_m},
                      {"pretrigger_samples", world.timing.pretrigger},
                      {"gauges", list(world.gauges, of_gauge)},
                      {"shots", list(world.shots, of_shot)}};
  if (campaign.split) {
    const TrueSpecimen& specimen = campaign.split->specimen;
    json["output_length_m"] = campaign.split->output_length_m;
    json["specimen"] = {{"solid", specimen.solid},           {"length_m", specimen.length_m},
                        {"diameter_m", specimen.diameter_m}, {"E1_Pa", specimen.E1_Pa},
                        {"E2_Pa", specimen.E2_Pa},           {"eta2_Pa_s", specimen.eta2_Pa_s}};
  }
  return json;
}

}  // namespace kolsky::testing

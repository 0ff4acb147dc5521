#include "clients/cli/reports/impact_run.hpp"
#include "clients/figure/impact_figure.hpp"
#include "processing/impact/filter.hpp"

namespace kolsky::cli {
namespace {

JsonValue describe(const impact::EnergyLedger& energy) {
  return JsonObject{{"initial_J", energy.initial_J},
                    {"kinetic_J", energy.kinetic_J},
                    {"stored_J", energy.stored_J},
                    {"dissipated_J", energy.dissipated_J},
                    {"radiated_J", energy.radiated_J},
                    {"friction_J", energy.friction_J},
                    {"contact_J", energy.contact_J},
                    {"sabot_J", energy.sabot_J},
                    {"closure", energy.closure},
                    {"worst_closure", energy.worst_closure},
                    {"dissipated_by_difference", energy.dissipated_by_difference}};
}

JsonValue describe(const impact::Solid& solid) {
  JsonList arms;
  for (const impact::SolidArm& arm : solid.arms) {
    arms.push_back(
        JsonObject{{"shear_Pa", arm.shear_Pa}, {"bulk_Pa", arm.bulk_Pa}, {"time_s", arm.time_s}});
  }
  return JsonObject{{"density_kg_m3", solid.density_kg_m3},
                    {"instantaneous_modulus_Pa", impact::instantaneous_modulus_Pa(solid)},
                    {"relaxed_modulus_Pa", impact::relaxed_modulus_Pa(solid)},
                    {"shear_relaxed_Pa", solid.shear_relaxed_Pa},
                    {"bulk_relaxed_Pa", solid.bulk_relaxed_Pa},
                    {"arms", std::move(arms)},
                    {"nonlinearity", solid.nonlinearity}};
}

JsonValue describe(const impact::Field& field) {
  JsonList r_m;
  JsonList z_m;
  std::vector<double> axial_stress_Pa;
  JsonList layers;
  for (const impact::FieldElement& element : field.elements) {
    r_m.push_back(std::vector<double>(element.r_m.begin(), element.r_m.end()));
    z_m.push_back(std::vector<double>(element.z_m.begin(), element.z_m.end()));
    axial_stress_Pa.push_back(element.axial_stress_Pa);
    layers.push_back(static_cast<std::uint64_t>(element.layer));
  }
  return JsonObject{{"time_s", field.time_s},
                    {"r_m", std::move(r_m)},
                    {"z_m", std::move(z_m)},
                    {"axial_stress_Pa", std::move(axial_stress_Pa)},
                    {"layer", std::move(layers)}};
}

JsonValue mesh_of(const impact::ImpactHistory& history) {
  return JsonObject{{"elements", static_cast<std::uint64_t>(history.elements)},
                    {"steps", static_cast<std::uint64_t>(history.steps)},
                    {"first_step_s", history.first_step_s},
                    {"least_step_s", history.least_step_s}};
}

}  // namespace

JsonValue describe(const ImpactRun& run) {
  const impact::ImpactHistory& history = run.history;
  const double interval_s = run.model.output_interval_s;
  // Numbers are of the history as it was calculated, lists as the bench samples.
  const double wanted_s = 1.0 / run.bench.sampling_frequency_Hz;
  const auto sampled = [&](const std::vector<double>& values) {
    return impact::values_at(values, interval_s, wanted_s);
  };
  JsonList probes;
  for (std::size_t i = 0; i < history.probe_strain.size(); ++i) {
    probes.push_back(JsonObject{
        {"name", run.probe_names[i]},
        {"radial_m", run.model.probes[i].radial_m},
        {"axial_m", run.model.probes[i].axial_m},
        {"strain", sampled(history.probe_strain[i])},
        {"strain_rate_per_s",
         sampled(impact::mean_rate(history.probe_strain[i], interval_s, kRateWindow_s))}});
  }
  JsonList gauges;
  for (std::size_t i = 0; i < history.gauge_strain.size(); ++i) {
    gauges.push_back(JsonObject{
        {"name", run.gauge_names[i]},
        {"position_m", run.model.gauge_positions_m[i]},
        {"strain",
         sampled(impact::low_passed(history.gauge_strain[i], interval_s, kGaugeCutoff_Hz))},
        {"strain_raw", sampled(history.gauge_strain[i])}});
  }
  JsonList fields;
  for (const impact::Field& field : history.fields) {
    fields.push_back(describe(field));
  }
  std::vector<double> force_N = impact::means_at(history.force_N, interval_s, wanted_s);
  std::vector<double> time_s;
  for (std::size_t n = 0; n < force_N.size(); ++n) {
    time_s.push_back(static_cast<double>(n) * wanted_s);
  }
  return JsonObject{{"speed_m_per_s", run.model.speed_m_per_s},
                    {"friction", run.model.friction},
                    {"target", impact::name_of(run.model.target.kind)},
                    {"reading", impact::name_of(run.core.reading)},
                    {"law", impact::name_of(run.core.law)},
                    {"peak_force_N", history.peak_force_N},
                    {"peak_time_s", history.peak_time_s},
                    {"contact_time_s", history.contact_time_s},
                    {"contact_threshold", "a hundredth of the peak force"},
                    {"release_time_s", history.release_time_s},
                    {"contact_radius_max_m", history.largest_contact_radius_m},
                    {"restitution", history.restitution},
                    {"rebound_speed_m_per_s", history.rebound_speed_m_per_s},
                    {"impulse_N_s", history.impulse_N_s},
                    {"sabot_impulse_N_s", history.sabot_impulse_N_s},
                    {"mass_kg", history.mass_kg},
                    {"mass_from_geometry_kg", run.mass.geometry_kg},
                    {"density_scale", run.mass.density_scale},
                    {"energy", describe(history.energy)},
                    {"core", describe(run.model.layers.front().solid)},
                    {"cover", describe(run.model.layers.back().solid)},
                    {"strained_share", history.strained_share},
                    {"falling_share", history.falling_share},
                    {"mesh", mesh_of(history)},
                    {"remarks", history.remarks},
                    {"probe_window_s", kRateWindow_s},
                    {"gauge_low_pass_Hz", kGaugeCutoff_Hz},
                    {"probes", std::move(probes)},
                    {"gauges", std::move(gauges)},
                    {"fields", std::move(fields)},
                    {"time_s", std::move(time_s)},
                    {"force_N", std::move(force_N)},
                    {"contact_radius_m", sampled(history.contact_radius_m)}};
}

}  // namespace kolsky::cli

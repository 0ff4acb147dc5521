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

JsonValue mesh_of(const impact::ImpactHistory& history) {
  return JsonObject{{"elements", static_cast<std::uint64_t>(history.elements)},
                    {"steps", static_cast<std::uint64_t>(history.steps)},
                    {"first_step_s", history.first_step_s},
                    {"least_step_s", history.least_step_s}};
}

}  // namespace

JsonValue describe(const ImpactRun& run) {
  const impact::ImpactHistory& history = run.history;
  JsonList probes;
  for (std::size_t i = 0; i < history.probe_strain.size(); ++i) {
    probes.push_back(JsonObject{
        {"name", run.probe_names[i]},
        {"radial_m", run.model.probes[i].radial_m},
        {"axial_m", run.model.probes[i].axial_m},
        {"strain", history.probe_strain[i]},
        {"strain_rate_per_s",
         impact::mean_rate(history.probe_strain[i], run.model.output_interval_s, kRateWindow_s)}});
  }
  JsonList gauges;
  for (std::size_t i = 0; i < history.gauge_strain.size(); ++i) {
    gauges.push_back(JsonObject{
        {"name", run.gauge_names[i]},
        {"position_m", run.model.gauge_positions_m[i]},
        {"strain",
         impact::low_passed(history.gauge_strain[i], run.model.output_interval_s, kGaugeCutoff_Hz)},
        {"strain_raw", history.gauge_strain[i]}});
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
                    {"time_s", history.time_s},
                    {"force_N", history.force_N},
                    {"contact_radius_m", history.contact_radius_m}};
}

}  // namespace kolsky::cli

#include <fmt/format.h>

#include <algorithm>

#include "clients/cli/reports/impact_run.hpp"
#include "clients/figure/impact_figure.hpp"
#include "clients/report/field_svg.hpp"
#include "clients/terminal/plot.hpp"

namespace kolsky::cli {
namespace {

constexpr std::size_t kNameColumns = 18;
constexpr int kPlotColumns = 100;
constexpr int kPlotRows = 14;

std::string row(const std::string& name, const std::string& text) {
  return "  " + padded_right(name, kNameColumns) + text + "\n";
}

std::string ball_text(const ImpactRun& run) {
  std::string text = fmt::format("{} in a core of {}, {}",
                                 with_unit(run.model.layers.back().outer_diameter_m, "m"),
                                 with_unit(run.model.layers.front().outer_diameter_m, "m"),
                                 fmt::format("{:.2f} g", 1e3 * run.history.mass_kg));
  if (run.mass.density_scale != 1.0) {
    text += fmt::format("; densities x {:.4f}, as geometry gives {:.2f} g", run.mass.density_scale,
                        1e3 * run.mass.geometry_kg);
  }
  return text;
}

std::string solid_text(const impact::Solid& solid, const impact::BallMaterial& filed) {
  std::string text = fmt::format("{} at once, {} relaxed",
                                 with_unit(impact::instantaneous_modulus_Pa(solid), "Pa"),
                                 with_unit(impact::relaxed_modulus_Pa(solid), "Pa"));
  const double kept = impact::instantaneous_modulus_Pa(solid) / filed.material.E1_Pa();
  if (std::abs(kept - 1.0) > 1e-3) {
    text += fmt::format(" (filed E1 {})", with_unit(filed.material.E1_Pa(), "Pa"));
  }
  return text;
}

std::string energy_text(const impact::EnergyLedger& energy) {
  const auto share = [&](double part_J) { return 100.0 * part_J / energy.initial_J; };
  std::string text = fmt::format(
      "of {}: kinetic {:.1f} %, stored {:.1f} %, dissipated {:.1f} %, into the target {:.1f} %, "
      "friction {:.1f} %",
      with_unit(energy.initial_J, "J"), share(energy.kinetic_J), share(energy.stored_J),
      share(energy.dissipated_J), share(energy.radiated_J), share(energy.friction_J));
  if (energy.sabot_J > 0.0) {
    text += fmt::format(", the sabot's {:.1f} %", share(energy.sabot_J));
  }
  constexpr double kShown = 0.05;  // %
  if (share(energy.contact_J) > kShown) {
    text += fmt::format(", left in the contact {:.1f} %", share(energy.contact_J));
  }
  return text + fmt::format("; closes to {:.3f} %", 100.0 * std::abs(energy.worst_closure));
}

std::string paragraph(const std::string& name, const std::string& text, int columns) {
  const std::size_t indent = 2 + kNameColumns;
  std::string joined;
  for (const std::string& line :
       wrapped(text, static_cast<std::size_t>(std::clamp(columns, 60, kPlotColumns)) - indent)) {
    joined += (joined.empty() ? "" : "\n" + std::string(indent, ' ')) + line;
  }
  return row(name, joined);
}

}  // namespace

std::string report(const ImpactRun& run, const Terminal& terminal) {
  const impact::ImpactHistory& history = run.history;
  std::string text =
      inked(fmt::format("impact at {} on {}, friction {:.3g}",
                        with_unit(run.model.speed_m_per_s, "m/s"),
                        run.model.target.kind == impact::TargetKind::rigid ? "a rigid plane"
                        : run.model.target.kind == impact::TargetKind::dashpot
                            ? "a plane with the bar's impedance"
                            : "the meshed bar",
                        run.model.friction),
            Ink::bold, terminal.colour) +
      "\n";
  text += row("ball", ball_text(run));
  text += row("reading", impact::name_of(run.core.reading) + ", " + impact::name_of(run.core.law) +
                             " stress from Hencky's strain");
  text += row("core", solid_text(run.model.layers.front().solid, run.core));
  text += row("cover", solid_text(run.model.layers.back().solid, run.cover));
  text += row("peak force", fmt::format("{} at {}", with_unit(history.peak_force_N, "N"),
                                        with_unit(history.peak_time_s, "s")));
  text +=
      row("contact", fmt::format("{} above a hundredth of the peak, last touch at {}, out to {}",
                                 with_unit(history.contact_time_s, "s"),
                                 with_unit(history.release_time_s, "s"),
                                 with_unit(history.largest_contact_radius_m, "m")));
  text += row("restitution",
              fmt::format("{:.4f} (the centre of mass leaves at {})", history.restitution,
                          with_unit(history.rebound_speed_m_per_s, "m/s")));
  text += paragraph("energy", energy_text(history.energy), terminal.columns);
  text +=
      row("mesh", fmt::format("{} elements, {} steps of {} and less, {:.2f} s", history.elements,
                              history.steps, with_unit(history.first_step_s, "s"), run.wall_s));
  for (const std::string& remark : history.remarks) {
    text += paragraph("note", remark, terminal.columns);
  }
  return text + "\n" +
         plot_text(contact_force_panel(history),
                   {std::min(terminal.columns, kPlotColumns), kPlotRows}, terminal.colour);
}

std::string page(const ImpactRun& run) {
  const impact::ImpactHistory& history = run.history;
  Figure figure;
  figure.title = fmt::format("Impact at {}, friction {:.3g}, {} reading",
                             with_unit(run.model.speed_m_per_s, "m/s"), run.model.friction,
                             impact::name_of(run.core.reading));
  figure.notes = {fmt::format("peak force {}, restitution {:.4f}, target {}, {} elements",
                              with_unit(history.peak_force_N, "N"), history.restitution,
                              impact::name_of(run.model.target.kind), history.elements)};
  figure.notes.insert(figure.notes.end(), history.remarks.begin(), history.remarks.end());
  figure.panels = {contact_force_panel(history), contact_radius_panel(history)};
  if (!history.probe_strain.empty()) {
    figure.panels.push_back(probe_rate_panel(history, run.probe_names));
  }
  if (!history.gauge_strain.empty()) {
    figure.panels.push_back(gauge_strain_panel(history, run.gauge_names));
  }
  return render_fields_svg(history.fields, figure);
}

}  // namespace kolsky::cli

#include "processing/impact/impact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "processing/impact/filter.hpp"
#include "tests/accuracy/table.hpp"
#include "tests/generators/impact_bar.hpp"
#include "tests/generators/known_balls.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace kolsky::accuracy {
namespace {

void add_pmma_bar(Section& section) {
  testing::PressedBar bar;
  bar.diameter_m = 0.020;
  bar.length_m = 1.0;
  bar.solid = impact::solid_of(paper_pmma(), impact::Reading::full);
  bar.across = 8;
  bar.gauges_m = {0.15, 0.45};
  bar.duration_s = 6.5e-4;
  bar.pressure_Pa = testing::bell(40e-6, 1e6);
  const auto records = testing::press(bar);
  constexpr std::array<std::array<double, 3>, 3> kRows{
      {{10e3, 2167.8, 0.6461}, {15e3, 2168.7, 0.6926}, {20e3, 2160.8, 0.7192}}};
  for (const auto& [frequency_Hz, speed, alpha] : kRows) {
    const testing::BarWave wave = testing::wave_between(records, 0.3, frequency_Hz, speed);
    section.rows.push_back({fmt::format("PMMA bar, c at {:.0f} kHz [m/s]", 1e-3 * frequency_Hz),
                            fmt::format("{:.1f}", speed), fmt::format("{:.1f}", wave.speed_m_per_s),
                            agreed(speed, wave.speed_m_per_s)});
    section.rows.push_back({fmt::format("PMMA bar, α at {:.0f} kHz [1/m]", 1e-3 * frequency_Hz),
                            fmt::format("{:.4f}", alpha),
                            fmt::format("{:.4f}", wave.attenuation_per_m),
                            agreed(alpha, wave.attenuation_per_m)});
  }
}

constexpr double kTitanium_Pa = 113e9;

testing::PressedBar titanium(std::size_t across) {
  testing::PressedBar bar;
  bar.diameter_m = 0.027;
  bar.length_m = 1.3;
  bar.solid = impact::elastic_solid(4420.0, kTitanium_Pa, 0.33);
  bar.across = across;
  bar.gauges_m = {0.25, 0.55};
  bar.duration_s = 3.2e-4;
  bar.pressure_Pa = testing::bell(15e-6, 1e6);
  return bar;
}

void add_titanium_bar(Section& section) {
  const double c0 = std::sqrt(kTitanium_Pa / 4420.0);
  const auto records = testing::press(titanium(12));
  constexpr std::array<std::pair<double, double>, 7> kPochhammer{{{10e3, 0.99923},
                                                                  {20e3, 0.99687},
                                                                  {30e3, 0.99275},
                                                                  {50e3, 0.97785},
                                                                  {60e3, 0.96573},
                                                                  {80e3, 0.92503},
                                                                  {100e3, 0.84124}}};
  for (const auto& [frequency_Hz, expected] : kPochhammer) {
    const double ratio =
        testing::wave_between(records, 0.3, frequency_Hz, expected * c0).speed_m_per_s / c0;
    section.rows.push_back({fmt::format("Ti bar, c/c0 at {:.0f} kHz", 1e-3 * frequency_Hz),
                            fmt::format("{:.5f}", expected), fmt::format("{:.5f}", ratio),
                            agreed(expected, ratio)});
  }
}

/// Mean over the ringing behind the front.
void add_step(Section& section) {
  constexpr double kPressure_Pa = 20e6;
  testing::PressedBar bar = titanium(4);
  bar.length_m = 0.8;
  bar.gauges_m = {0.2};
  bar.duration_s = 1.9e-4;
  bar.pressure_Pa = [](double) { return kPressure_Pa; };
  const auto records = testing::press(bar);
  const double front_s = 0.2 / std::sqrt(kTitanium_Pa / 4420.0);
  double sum = 0.0;
  double count = 0.0;
  for (std::size_t n = 0; n < records.strain[0].size(); ++n) {
    if (static_cast<double>(n) * records.interval_s > front_s + 60e-6) {
      sum += records.strain[0][n];
      count += 1.0;
    }
  }
  const double over = sum / count / (kPressure_Pa / kTitanium_Pa);
  section.rows.push_back({"step of pressure, strain behind the front over p/E", "1",
                          fmt::format("{:.5f}", over), agreed(1.0, over)});
}

void add_spheres(Section& section) {
  const double breathing_Hz = testing::breathing_frequency_Hz(2048);
  section.rows.push_back(
      {"breathing sphere, ν 0.3 [Hz]", fmt::format("{:.2f}", testing::kBreathing_Hz),
       fmt::format("{:.2f}", breathing_Hz), agreed(testing::kBreathing_Hz, breathing_Hz)});
  const testing::HertzRun large = testing::hertz(2.0, 4096);
  const testing::HertzRun small = testing::hertz(0.8, 8192);
  const double slope = (large.ratio - small.ratio) / (large.patch - small.patch);
  const double none = small.ratio - slope * small.patch;
  section.rows.push_back({"elastic sphere on a wall, contact time over Hertz's as a/R goes to 0",
                          "1", fmt::format("{:.4f}", none), agreed(1.0, none)});
  section.rows.push_back(
      {"its slope by a/R", "-0.29", fmt::format("{:.3f}", slope), agreed(-0.29, slope)});
  const double peak_by_patch = (large.peak - small.peak) / (large.patch - small.patch);
  const double peak = small.peak - peak_by_patch * small.patch;
  section.rows.push_back({"its largest force over Hertz's as a/R goes to 0", "1",
                          fmt::format("{:.3f}", peak), agreed(1.0, peak)});
  section.rows.push_back(
      {fmt::format("its largest contact radius over Hertz's, a/R {:.2f}", small.patch), "1",
       fmt::format("{:.3f}", small.radius), agreed(1.0, small.radius)});
  section.rows.push_back({"its impulse over 2 m V", "1", fmt::format("{:.5f}", small.impulse),
                          agreed(1.0, small.impulse)});
}

/// The paper's ball on a bar in elements, with a gauge at 250 mm, and on a dashpot.
void add_balls(Section& section) {
  impact::ImpactModel model = testing::paper_impact(40.3, impact::TargetKind::bar);
  model.elements = 512;
  model.bar_elements_across = 4;
  model.gauge_positions_m = {0.250};
  const auto bar = impact::simulate(model);
  const double force_per_strain_N = model.target.youngs_modulus_Pa * model.target.area_m2();
  const double interval_s = model.output_interval_s;
  model = testing::paper_impact(40.3);
  model.elements = 512;
  const auto dashpot = impact::simulate(model);
  const auto add = [&](const std::string& name, double reference, double ours, const char* form) {
    section.rows.push_back({name, fmt::format(fmt::runtime(form), reference),
                            fmt::format(fmt::runtime(form), ours), agreed(reference, ours)});
  };
  add("ball, dashpot against meshed bar: peak [N]", bar.peak_force_N, dashpot.peak_force_N,
      "{:.0f}");
  add("ball, dashpot against meshed bar: restitution", bar.restitution, dashpot.restitution,
      "{:.4f}");
  const auto largest = [&](const std::vector<double>& values) {
    const auto smooth = impact::low_passed(values, interval_s, 50e3);
    return *std::max_element(smooth.begin(), smooth.end());
  };
  const std::vector<double>& strain = bar.gauge_strain[0];
  add("ball, gauge at 250 mm against contact force: peak [N]", largest(bar.force_N),
      force_per_strain_N * largest(strain), "{:.0f}");
  add("ball, gauge at 250 mm against contact force: impulse [N s]", bar.impulse_N_s,
      force_per_strain_N * interval_s * std::accumulate(strain.begin(), strain.end(), 0.0),
      "{:.4f}");
  add("ball, impulse on the target over m (Vi + Vr)", 1.0,
      dashpot.impulse_N_s / (dashpot.mass_kg * (40.3 + dashpot.rebound_speed_m_per_s)), "{:.6f}");
  add("ball, energy where it closes worst over that at the start", 1.0,
      1.0 + dashpot.energy.worst_closure, "{:.4f}");
  model = testing::paper_impact(40.3, impact::TargetKind::rigid);
  model.elements = 512;
  add("the same on a rigid target", 1.0, 1.0 + impact::simulate(model).energy.worst_closure,
      "{:.4f}");
  model.elements = 2048;
  add("the same, 2048 elements", 1.0, 1.0 + impact::simulate(model).energy.worst_closure, "{:.4f}");
}

}  // namespace

std::optional<Section> impacts() {
  Section section{
      "Impact solver",
      "Coarse meshes (4 to 12 elements over a bar's radius, 512 in the paper's ball, 2048 to "
      "8192 in elastic spheres), to be quick; finer ones are in [impact.md](impact.md). "
      "References are theory, but for the ball: there this solver on another target, and "
      "its own gauge. That the impulse is m (Vi + Vr) to twelve digits says nothing: the "
      "scheme keeps it by itself.",
      {"case", "reference", "ours", "digits agreed"},
      {}};
  add_pmma_bar(section);
  add_titanium_bar(section);
  add_step(section);
  add_spheres(section);
  add_balls(section);
  return section;
}

}  // namespace kolsky::accuracy

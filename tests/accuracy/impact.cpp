#include "processing/impact/impact.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "tests/accuracy/table.hpp"
#include "tests/generators/impact_bar.hpp"
#include "tests/unit/impact/paper_ball.hpp"

namespace kolsky::accuracy {
namespace {

struct Wave {
  double speed_m_per_s = 0.0;
  double attenuation_per_m = 0.0;
};

std::complex<double> component(const std::vector<double>& samples, double interval_s,
                               double frequency_Hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    sum += samples[n] * std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz * interval_s *
                                            static_cast<double>(n));
  }
  return sum;
}

/// From two gauges; the nominal speed finds the turn of the phase.
Wave wave_between(const testing::BarRecords& records, double distance_m, double frequency_Hz,
                  double nominal_m_per_s) {
  const auto ratio = component(records.strain[1], records.interval_s, frequency_Hz) /
                     component(records.strain[0], records.interval_s, frequency_Hz);
  const double foretold = 2.0 * std::numbers::pi * frequency_Hz * distance_m / nominal_m_per_s;
  const double turns = std::round((foretold + std::arg(ratio)) / (2.0 * std::numbers::pi));
  const double phase = 2.0 * std::numbers::pi * turns - std::arg(ratio);
  return {2.0 * std::numbers::pi * frequency_Hz * distance_m / phase,
          -std::log(std::abs(ratio)) / distance_m};
}

std::function<double(double)> bell(double length_s) {
  return [=](double t) {
    const double half = std::sin(std::numbers::pi * t / length_s);
    return t < length_s ? 1e6 * half * half : 0.0;
  };
}

void add_pmma_bar(Section& section) {
  testing::PressedBar bar;
  bar.diameter_m = 0.020;
  bar.length_m = 1.0;
  bar.solid = impact::solid_of(paper_pmma(), impact::Reading::full);
  bar.across = 8;
  bar.gauges_m = {0.15, 0.45};
  bar.duration_s = 6.5e-4;
  bar.pressure_Pa = bell(40e-6);
  const auto records = testing::press(bar);
  constexpr std::array<std::array<double, 3>, 3> kRows{
      {{10e3, 2167.8, 0.6461}, {15e3, 2168.7, 0.6926}, {20e3, 2160.8, 0.7192}}};
  for (const auto& [frequency_Hz, speed, alpha] : kRows) {
    const Wave wave = wave_between(records, 0.3, frequency_Hz, speed);
    section.rows.push_back({fmt::format("PMMA bar, c at {:.0f} kHz [m/s]", 1e-3 * frequency_Hz),
                            fmt::format("{:.1f}", speed), fmt::format("{:.1f}", wave.speed_m_per_s),
                            agreed(speed, wave.speed_m_per_s)});
    section.rows.push_back({fmt::format("PMMA bar, α at {:.0f} kHz [1/m]", 1e-3 * frequency_Hz),
                            fmt::format("{:.4f}", alpha),
                            fmt::format("{:.4f}", wave.attenuation_per_m),
                            agreed(alpha, wave.attenuation_per_m)});
  }
}

void add_titanium_bar(Section& section) {
  constexpr double kModulus_Pa = 113e9;
  const double c0 = std::sqrt(kModulus_Pa / 4420.0);
  testing::PressedBar bar;
  bar.diameter_m = 0.027;
  bar.length_m = 1.3;
  bar.solid = impact::elastic_solid(4420.0, kModulus_Pa, 0.33);
  bar.across = 8;
  bar.gauges_m = {0.25, 0.55};
  bar.duration_s = 3.2e-4;
  bar.pressure_Pa = bell(15e-6);
  const auto records = testing::press(bar);
  for (const auto& [frequency_Hz, expected] :
       {std::pair{10e3, 0.99923}, std::pair{20e3, 0.99687}, std::pair{30e3, 0.99275}}) {
    const double ratio = wave_between(records, 0.3, frequency_Hz, expected * c0).speed_m_per_s / c0;
    section.rows.push_back({fmt::format("Ti bar, c/c0 at {:.0f} kHz", 1e-3 * frequency_Hz),
                            fmt::format("{:.5f}", expected), fmt::format("{:.5f}", ratio),
                            agreed(expected, ratio)});
  }
}

void add_balls(Section& section) {
  impact::ImpactModel model = testing::paper_impact(31.1);
  model.elements = 512;
  const auto ball = impact::simulate(model);
  const double momentum = ball.mass_kg * (model.speed_m_per_s + ball.rebound_speed_m_per_s);
  section.rows.push_back({"ball, impulse over m (Vi + Vr)", "1",
                          fmt::format("{:.6f}", ball.impulse_N_s / momentum),
                          agreed(1.0, ball.impulse_N_s / momentum)});
  section.rows.push_back({"ball, energy at the end over that at the start", "1",
                          fmt::format("{:.4f}", 1.0 + ball.energy.closure),
                          agreed(1.0, 1.0 + ball.energy.closure)});
}

}  // namespace

std::optional<Section> impacts() {
  Section section{"Impact solver",
                  "Coarse meshes (8 elements over a bar's radius, 512 in the ball), to be quick; "
                  "finer ones are in [impact.md](impact.md).",
                  {"case", "reference", "ours", "digits agreed"},
                  {}};
  add_pmma_bar(section);
  add_titanium_bar(section);
  add_balls(section);
  return section;
}

}  // namespace kolsky::accuracy

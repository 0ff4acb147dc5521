#include "tests/generators/impact_bar.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "processing/impact/body.hpp"

namespace kolsky::testing {
namespace {

using impact::Block;
using impact::Body;

constexpr double kSafety = 0.8;

std::complex<double> component(const std::vector<double>& samples, double interval_s,
                               double frequency_Hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t n = 0; n < samples.size(); ++n) {
    sum += samples[n] * std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz * interval_s *
                                            static_cast<double>(n));
  }
  return sum;
}

// Area of the face that each of its nodes answers for, consistent with linear edges.
std::vector<double> face_areas(const Body& body) {
  const std::vector<std::size_t>& face = body.mesh().surface;
  std::vector<double> areas(face.size(), 0.0);
  for (std::size_t k = 0; k + 1 < face.size(); ++k) {
    const double a = body.mesh().R_m[face[k]];
    const double b = body.mesh().R_m[face[k + 1]];
    areas[k] += std::numbers::pi / 3.0 * (b - a) * (2.0 * a + b);
    areas[k + 1] += std::numbers::pi / 3.0 * (b - a) * (a + 2.0 * b);
  }
  return areas;
}

// The surface's strain between the middles of the two nearest elements' edges.
double surface_strain(const Body& body, double position_m) {
  const Block& block = body.mesh().blocks.front();
  const double size_m = -body.mesh().Z_m[block.node(0, 0)] / static_cast<double>(block.rows);
  const double place = static_cast<double>(block.rows) - position_m / size_m - 0.5;
  const auto row = static_cast<std::size_t>(place);
  const double share = place - static_cast<double>(row);
  const auto strain = [&](std::size_t j) {
    return (body.axial_displacement(block.node(block.columns, j)) -
            body.axial_displacement(block.node(block.columns, j + 1))) /
           size_m;
  };
  return (1.0 - share) * strain(row) + share * strain(row + 1);
}

}  // namespace

BarRecords press(const PressedBar& bar) {
  const double size_m = 0.5 * bar.diameter_m / static_cast<double>(bar.across);
  const auto along = static_cast<std::size_t>(std::lround(bar.length_m / size_m));
  Body body(impact::bar_mesh(bar.diameter_m, bar.length_m, bar.across, along), {bar.solid});
  const double step_s = kSafety * 2.0 / body.highest_frequency();
  const std::vector<double> areas = face_areas(body);
  BarRecords records{step_s, std::vector<std::vector<double>>(bar.gauges_m.size())};
  for (std::size_t n = 0; static_cast<double>(n) * step_s <= bar.duration_s; ++n) {
    body.set_steps(n == 0 ? 0.0 : step_s, step_s);
    (void)body.find_forces(false);
    const double pressure_Pa = bar.pressure_Pa(static_cast<double>(n) * step_s);
    for (std::size_t k = 0; k < areas.size(); ++k) {
      body.push(body.mesh().surface[k], 0.0, -pressure_Pa * areas[k]);
    }
    for (std::size_t g = 0; g < bar.gauges_m.size(); ++g) {
      records.strain[g].push_back(surface_strain(body, bar.gauges_m[g]));
    }
    body.advance(n == 0 ? 0.5 * step_s : step_s, step_s);
  }
  return records;
}

std::function<double(double)> bell(double length_s, double peak_Pa) {
  return [=](double t) {
    const double half = std::sin(std::numbers::pi * t / length_s);
    return t < length_s ? peak_Pa * half * half : 0.0;
  };
}

BarWave wave_between(const BarRecords& records, double distance_m, double frequency_Hz,
                     double nominal_m_per_s) {
  const std::complex<double> ratio =
      component(records.strain[1], records.interval_s, frequency_Hz) /
      component(records.strain[0], records.interval_s, frequency_Hz);
  const double foretold = 2.0 * std::numbers::pi * frequency_Hz * distance_m / nominal_m_per_s;
  const double turns = std::round((foretold + std::arg(ratio)) / (2.0 * std::numbers::pi));
  const double phase = 2.0 * std::numbers::pi * turns - std::arg(ratio);
  return {2.0 * std::numbers::pi * frequency_Hz * distance_m / phase,
          -std::log(std::abs(ratio)) / distance_m};
}

}  // namespace kolsky::testing

#include "tests/generators/known_balls.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "processing/impact/body.hpp"
#include "processing/impact/impact.hpp"

namespace kolsky::testing {
namespace {

using impact::Body;
using impact::elastic_solid;
using impact::ImpactHistory;
using impact::ImpactModel;
using impact::Mesh;

constexpr double kDiameter_m = 0.0427;
constexpr double kRadius_m = 0.5 * kDiameter_m;

}  // namespace

// By the zero crossings of a volume-like sum.
double breathing_frequency_Hz(std::size_t elements) {
  constexpr std::array kDiameters = {kDiameter_m};
  Body body(impact::ball_mesh(kDiameters, elements), {elastic_solid(1100.0, 100e6, 0.3)});
  const Mesh& mesh = body.mesh();
  const double xi_per_m = 2.67021 / kRadius_m;
  std::vector<double> radial(mesh.R_m.size(), 0.0);
  std::vector<double> axial(mesh.R_m.size(), 0.0);
  const auto along_mode = [&](auto&& act) {
    for (std::size_t n = 0; n < mesh.R_m.size(); ++n) {
      if (body.nodal_mass_kg(n) > 0.0) {
        act(n, mesh.R_m[n], mesh.Z_m[n] - kRadius_m);
      }
    }
  };
  along_mode([&](std::size_t n, double R, double Z) {
    const double r = std::max(std::hypot(R, Z), 1e-9);
    const double x = xi_per_m * r;
    const double mode = (std::sin(x) / x - std::cos(x)) / x;  // spherical Bessel j1
    radial[n] = 1e-3 * mode * R / r;
    axial[n] = 1e-3 * mode * Z / r;
  });
  body.set_velocity(radial, axial);
  const double step_s = 0.5 * 2.0 / body.highest_frequency();
  double before = 0.0;
  std::vector<double> crossings_s;
  for (std::size_t n = 0; crossings_s.size() < 7; ++n) {
    (void)body.find_forces(false);
    body.join_ties();
    double swelling = 0.0;
    along_mode([&](std::size_t node, double R, double Z) {
      swelling += body.nodal_mass_kg(node) *
                  (R * (body.r_m(node) - R) + Z * (body.z_m(node) - kRadius_m - Z));
    });
    if (n > 1 && before * swelling < 0.0) {
      crossings_s.push_back((static_cast<double>(n) - swelling / (swelling - before)) * step_s);
    }
    before = swelling;
    body.advance(n == 0 ? 0.0 : step_s, step_s);
  }
  return 3.0 / (crossings_s[6] - crossings_s[0]);
}

HertzRun hertz(double speed_m_per_s, std::size_t elements) {
  ImpactModel model;
  model.layers = {{kDiameter_m, elastic_solid(1100.0, 100e6, 0.3)}};
  model.speed_m_per_s = speed_m_per_s;
  model.friction = 0.0;
  model.elements = elements;
  const ImpactHistory history = simulate(model);
  const double stiffness = 4.0 / 3.0 * 100e6 / (1.0 - 0.09) * std::sqrt(kRadius_m);
  const double depth_m =
      std::pow(1.25 * history.mass_kg * speed_m_per_s * speed_m_per_s / stiffness, 0.4);
  return {std::sqrt(depth_m / kRadius_m),
          history.release_time_s / (2.943 * depth_m / speed_m_per_s),
          history.peak_force_N / (stiffness * std::pow(depth_m, 1.5)),
          history.largest_contact_radius_m / std::sqrt(kRadius_m * depth_m),
          history.impulse_N_s / (2.0 * history.mass_kg * speed_m_per_s)};
}

}  // namespace kolsky::testing

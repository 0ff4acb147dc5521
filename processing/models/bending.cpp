#include "processing/models/bending.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

/// Curvature at x over psi'(0) of a semi-infinite Timoshenko beam whose end carries a moment and no
/// shear force: of the rotation, psi', or of the deflection, w''. With w, psi ~ exp(-beta x):
///   beta^4 - rho s^2 (J + 1/(kappa G)) beta^2 + rho s^2 J (A/I + rho s^2/(kappa G)) = 0,
///   psi = w (rho s^2/(kappa G) - beta^2) / beta.
Complex curvature_ratio(const BarScene& bar, Complex s, Complex J, double x, bool of_deflection) {
  const double nu = bar.poisson_ratio;
  const double kappa = 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu);
  const Complex shear = 2.0 * (1.0 + nu) * J / kappa;  // 1/(kappa G)
  const Complex inertia = bar.density_kg_m3 * s * s;
  const double radius_of_gyration2 = bar.radius_m * bar.radius_m / 4.0;
  const Complex half = inertia * (J + shear) / 2.0;
  const Complex product = inertia * J * (1.0 / radius_of_gyration2 + inertia * shear);
  const Complex root = std::sqrt(half * half - product);
  const auto decaying = [](Complex square) {
    const Complex beta = std::sqrt(square);
    return beta.real() >= 0.0 ? beta : -beta;
  };
  const Complex b1 = decaying(half + root);
  const Complex b2 = decaying(half - root);
  const Complex psi1 = (inertia * shear - b1 * b1) / b1;
  const Complex psi2 = (inertia * shear - b2 * b2) / b2;
  // No shear: sum of (w' - psi) = 0, each -w inertia shear / beta.
  const Complex w2_over_w1 = -b2 / b1;
  const Complex near = -b1 * psi1;
  const Complex far = -b2 * psi2 * w2_over_w1;
  const Complex near_seen = of_deflection ? b1 * b1 : near;
  const Complex far_seen = of_deflection ? b2 * b2 * w2_over_w1 : far;
  return (near_seen * std::exp(-b1 * x) + far_seen * std::exp(-b2 * x)) / (near + far);
}

}  // namespace

bool bends(const Scene& scene) {
  return std::ranges::any_of(scene.gauges, [](const GaugeScene& gauge) {
    return gauge.offset_m != 0.0 && gauge.bar == 0;
  });
}

void add_bending(const Scene& scene, std::span<const Complex> struck_end,
                 std::vector<std::vector<Complex>>& readings) {
  const BarScene& bar = scene.bars.front();
  for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
    const GaugeScene& gauge = scene.gauges[j];
    if (gauge.offset_m == 0.0 || gauge.bar != 0) {
      continue;
    }
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      // Moment over E I at unit eccentricity: force J / (pi a^4 / 4), times a.
      const Complex s = scene.s[k];
      const Complex stress =
          bar.density_kg_m3 * s * s / (bar.gamma_per_m[k] * bar.gamma_per_m[k]) * struck_end[k];
      const Complex J = bar.J_per_Pa[k];
      readings[j][k] += gauge.offset_m * 4.0 / bar.radius_m * stress * J *
                        curvature_ratio(bar, s, J, gauge.position_m, gauge.bends_as_deflection);
    }
  }
}

}  // namespace kolsky

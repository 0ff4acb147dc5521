#include "processing/models/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

BarScene scene_of(const Bar& bar) {
  if (bar.material) {
    throw InputError("bars.output.material",
                     "is filed, and a model has one material for all viscoelastic bars",
                     "leave it out where both are of one, or reduce and identify with the bench as "
                     "it is");
  }
  BarScene scene;
  scene.length_m = bar.length_m;
  scene.radius_m = bar.dispersion_radius_m();
  scene.area_m2 = bar.area_m2();
  scene.density_kg_m3 = bar.density_kg_m3;
  scene.poisson_ratio = bar.poisson_ratio;
  if (bar.youngs_modulus_Pa) {
    scene.elastic = true;
    scene.solid.E1_Pa = *bar.youngs_modulus_Pa;
    scene.solid.E2_Pa = std::numeric_limits<double>::infinity();
  }
  return scene;
}

}  // namespace

Complex Solid::compliance(Complex s, std::size_t k) const {
  Complex J = 1.0 / E1_Pa;
  if (std::isfinite(E2_Pa)) {
    J += beta == 1.0 ? 1.0 / (E2_Pa + s * eta2_Pa_s)
                     : 1.0 / (E2_Pa * (1.0 + std::pow(s * (eta2_Pa_s / E2_Pa), beta)));
  }
  for (const Relaxation& relaxation : relaxations) {
    J += relaxation.D_per_Pa / (1.0 + s * relaxation.tau_s);
  }
  if (phi_per_Pa_s != 0.0) {
    J += phi_per_Pa_s / s;
  }
  return further_per_Pa.empty() ? J : J + further_per_Pa[k];
}

double SpecimenScene::area_m2() const {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

double SpecimenScene::share_of_stress(double strain) const {
  const double h = length_m * (1.0 - strain);
  const double d = diameter_m / std::sqrt(1.0 - strain);
  return 1.0 / (1.0 + friction * d / (3.0 * h));
}

bool SpecimenScene::nonlinear() const {
  return stiffening != 0.0 || friction != 0.0 || gap_m != 0.0 || parts ||
         lateral_inertia_kg_per_m != 0.0 || !further_strain.empty();
}

void RecordScene::straighten(std::size_t gauge, std::vector<double>& record) const {
  if (gauge < gains.size()) {
    for (std::size_t n = 0; n < gains[gauge].size(); ++n) {
      record[n] /= gains[gauge][n];
    }
  }
  if (gauge < maps.size()) {
    for (auto map = maps[gauge].rbegin(); map != maps[gauge].rend(); ++map) {
      undo(*map, record);
    }
  }
  if (bridge_b != 0.0 || bridge_c != 0.0) {
    for (double& e : record) {
      const double root = 1.0 + 4.0 * bridge_b * e;
      e = 2.0 * e / (1.0 + std::sqrt(std::max(root, 0.0)));
      e -= bridge_c * e * e * e;
    }
  }
}

Scene::Scene(const Bench& bench, const ShotFacts& shot, std::span<const Complex> path)
    : s(path.begin(), path.end()), facts(&shot) {
  bars.push_back(scene_of(bench.input));
  if (bench.output) {
    bars.push_back(scene_of(*bench.output));
    bars.back().far_reflection = bench.output->far_end == FarEnd::free ? -1.0 : 0.0;
  }
  for (const Gauge& gauge : bench.gauges) {
    GaugeScene g;
    g.name = gauge.name;
    g.bar = gauge.bar == "output" ? 1 : 0;
    g.position_m = gauge.position_m;
    g.length_m = gauge.length_m.value_or(Measured{}).value;
    g.factor.assign(path.size(), 1.0);
    for (std::size_t k = 0; gauge.delay_s != 0.0 && k < path.size(); ++k) {
      g.factor[k] = std::exp(-path[k] * gauge.delay_s.value);
    }
    gauges.push_back(std::move(g));
  }
  if (bench.specimen) {
    SpecimenScene sp;
    sp.length_m = bench.specimen->length_m;
    sp.diameter_m = bench.specimen->diameter_m;
    sp.density_kg_m3 = bench.specimen->density_kg_m3.value_or(Measured{}).value;
    sp.poisson_ratio = bench.specimen->poisson_ratio.value_or(Measured{}).value;
    specimen = sp;
  }
  if (bench.kind == BenchKind::impact) {
    ball.emplace();
    ball->core_diameter_m = bench.ball->core_diameter_m;
    ball->outer_diameter_m = bench.ball->outer_diameter_m;
  }
  record.additions.resize(gauges.size());
}

}  // namespace kolsky

#include "processing/models/transfers.hpp"

#include <algorithm>
#include <cmath>

#include "processing/models/bending.hpp"

namespace kolsky {

namespace {

/// sinh(x) / x, entire.
Complex sinhc(Complex x) {
  if (std::abs(x) < 1e-3) {
    return 1.0 + x * x / 6.0;
  }
  return std::sinh(x) / x;
}

/// Both faces: k F (1 - nu^2) J / d_s, k = 1.08 (1 - d_s/D)^1.3, per unit force.
Complex indentation_m_per_N(const BarScene& bar, const SpecimenScene& specimen, std::size_t at) {
  const double share = specimen.diameter_m / (2.0 * bar.radius_m);
  const double k = share < 1.0 ? 1.08 * std::pow(1.0 - share, 1.3) : 0.0;
  const double nu = bar.poisson_ratio;
  return k * (1.0 - nu * nu) * bar.J_per_Pa[at] / specimen.diameter_m;
}

/// Answers of bars and specimen at one place of the path to a unit wave arriving at interface A and
/// to a unit strain q.
struct Junction {
  Complex reflected, transmitted;  ///< mean strains leaving the interfaces
  Complex reflected_q, transmitted_q;
  Complex stress_per_transmitted;
  Complex strain, strain_q;
};

Junction junction(const Scene& scene, std::size_t at) {
  const BarScene& in = scene.bars[0];
  const BarScene& out = scene.bars[1];
  const SpecimenScene& specimen = *scene.specimen;
  const Complex s = scene.s[at];
  const double l = specimen.length_m;
  const double area = specimen.area_m2();
  const Complex round_trip =
      out.reflection(at) * std::exp(-2.0 * out.gamma_per_m[at] * out.length_m);
  // Force and velocity per unit mean strain of a wave.
  const Complex Z1 =
      in.area_m2 * in.density_kg_m3 * s * s / (in.gamma_per_m[at] * in.gamma_per_m[at]);
  const Complex V1 = s / in.gamma_per_m[at];
  const Complex Z2 = out.area_m2 * out.density_kg_m3 * s * s /
                     (out.gamma_per_m[at] * out.gamma_per_m[at]) * (1.0 + round_trip);
  const Complex V2 = s / out.gamma_per_m[at] * (1.0 - round_trip);
  Complex J = specimen.solid.compliance(s, at);
  // Lateral inertia's linear part: stress += m strain'' / 8.
  J /= 1.0 + J * specimen.lateral_inertia_kg_per_m * s * s / 8.0;
  const Complex crossing = l * s * std::sqrt(specimen.wave_density_kg_m3 * J);
  const Complex C = std::cosh(crossing);
  const Complex S = sinhc(crossing);
  const Complex dents = specimen.punching * (indentation_m_per_N(in, specimen, at) +
                                             indentation_m_per_N(out, specimen, at));
  const Complex force_a = Z2 * C + s * specimen.wave_density_kg_m3 * l * area * S * V2;
  const Complex velocity_a = V2 * C + Z2 * s * (l * J / area * S + dents);
  const Complex whole = velocity_a + V1 * force_a / Z1;
  Junction j;
  j.transmitted = 2.0 * V1 / whole;
  j.reflected = force_a * j.transmitted / Z1 - 1.0;
  j.transmitted_q = -s * l / whole;
  j.reflected_q = force_a * j.transmitted_q / Z1;
  j.stress_per_transmitted = Z2 / area;
  const Complex shortening = velocity_a - V2 - Z2 * s * dents;
  j.strain = shortening * j.transmitted / (s * l);
  j.strain_q = shortening * j.transmitted_q / (s * l) + 1.0;
  return j;
}

void set_bar_readings(const Scene& scene, std::size_t reference, Transfers& transfers) {
  const BarScene& bar = scene.bars.front();
  const double x0 = scene.gauges[reference].position_m;
  for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
    const GaugeScene& gauge = scene.gauges[j];
    const double x = gauge.position_m;
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      const Complex gamma = bar.gamma_per_m[k];
      Complex wave = std::exp(-gamma * (x - x0));
      if (bar.reflects()) {
        wave += bar.reflection(k) * std::exp(-gamma * (2.0 * bar.length_m - x - x0));
      }
      transfers.reading[j][k] = wave * bar.surface_over_mean[k];
    }
  }
}

void set_shpb_readings(const Scene& scene, std::size_t reference, Transfers& transfers) {
  const BarScene& in = scene.bars[0];
  const BarScene& out = scene.bars[1];
  const double x0 = scene.gauges[reference].position_m;
  const bool nonlinear = scene.specimen->nonlinear();
  const std::size_t places = scene.s.size();
  if (nonlinear) {
    transfers.reading_of_q.assign(scene.gauges.size(), Transfers::Spectrum(places));
    for (auto* spectrum :
         {&transfers.stress, &transfers.stress_of_q, &transfers.strain, &transfers.strain_of_q}) {
      spectrum->resize(places);
    }
  }
  for (std::size_t k = 0; k < places; ++k) {
    const Junction joint = junction(scene, k);
    const Complex arriving = std::exp(-in.gamma_per_m[k] * (in.length_m - x0));
    for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
      const GaugeScene& gauge = scene.gauges[j];
      const double x = gauge.position_m;
      Complex of_source;
      Complex of_q;
      if (gauge.bar == 0) {
        const Complex back = std::exp(-in.gamma_per_m[k] * (in.length_m - x));
        of_source = std::exp(-in.gamma_per_m[k] * (x - x0)) + joint.reflected * arriving * back;
        of_q = joint.reflected_q * back;
      } else {
        const Complex there =
            std::exp(-out.gamma_per_m[k] * x) +
            out.reflection(k) * std::exp(-out.gamma_per_m[k] * (2.0 * out.length_m - x));
        of_source = joint.transmitted * arriving * there;
        of_q = joint.transmitted_q * there;
      }
      const Complex surface = scene.bars[gauge.bar].surface_over_mean[k];
      transfers.reading[j][k] = of_source * surface;
      if (nonlinear) {
        transfers.reading_of_q[j][k] = of_q * surface;
      }
    }
    if (nonlinear) {
      transfers.stress[k] = joint.stress_per_transmitted * joint.transmitted * arriving;
      transfers.stress_of_q[k] = joint.stress_per_transmitted * joint.transmitted_q;
      transfers.strain[k] = joint.strain * arriving;
      transfers.strain_of_q[k] = joint.strain_q;
    }
  }
}

/// Bending, the sensors' own factors, then what neighbours pick up.
void pass_sensors(const Scene& scene, std::size_t reference, Transfers& transfers) {
  add_bending(scene, reference, transfers.reading);
  for (auto* readings : {&transfers.reading, &transfers.reading_of_q}) {
    if (readings->empty()) {
      continue;
    }
    for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
      for (std::size_t k = 0; k < scene.s.size(); ++k) {
        const Complex factor = scene.gauges[j].factor[k];
        (*readings)[j][k] *=
            (j == reference ? invertible(factor) : factor) * mean_over_length(scene, j, k);
      }
    }
    const auto clean = *readings;
    for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
      for (const auto& [neighbour, share] : scene.gauges[j].picks_up) {
        for (std::size_t k = 0; k < scene.s.size(); ++k) {
          (*readings)[j][k] += share * clean[neighbour][k];
        }
      }
    }
  }
}

}  // namespace

Complex mean_over_length(const Scene& scene, std::size_t gauge, std::size_t at) {
  const GaugeScene& own = scene.gauges[gauge];
  return sinhc(scene.bars[own.bar].gamma_per_m[at] * own.length_m / 2.0);
}

Complex invertible(Complex factor) {
  constexpr double kSeesWell = 0.7;
  constexpr double kBlind = 0.15;
  const double size = std::abs(factor);
  return size > kSeesWell ? factor : factor * (1.0 + std::pow(kBlind / std::max(size, 1e-6), 8));
}

void set_elementary_waves(Scene& scene) {
  const std::size_t places = scene.s.size();
  for (BarScene& bar : scene.bars) {
    bar.J_per_Pa.resize(places);
    bar.gamma_per_m.resize(places);
    bar.surface_over_mean.assign(places, 1.0);
    for (std::size_t k = 0; k < places; ++k) {
      bar.J_per_Pa[k] = bar.solid.compliance(scene.s[k], k);
      bar.gamma_per_m[k] = scene.s[k] * std::sqrt(bar.density_kg_m3 * bar.J_per_Pa[k]);
    }
  }
}

Transfers transfers_of(const Scene& scene, std::size_t reference) {
  Transfers transfers;
  transfers.reading.assign(scene.gauges.size(), Transfers::Spectrum(scene.s.size()));
  if (scene.bars.size() == 1) {
    set_bar_readings(scene, reference, transfers);
  } else {
    set_shpb_readings(scene, reference, transfers);
  }
  pass_sensors(scene, reference, transfers);
  return transfers;
}

}  // namespace kolsky

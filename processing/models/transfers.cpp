#include "processing/models/transfers.hpp"

#include <algorithm>
#include <cmath>

#include "processing/models/bending.hpp"
#include "processing/models/lateral_inertia.hpp"
#include "processing/waves/each_exp.hpp"

namespace kolsky {

namespace {

/// exp(-gamma x) of a bar's waves.
std::vector<Complex> over(const BarScene& bar, double x) {
  std::vector<Complex> wave;
  wave.reserve(bar.gamma_per_m.size());
  for (const Complex gamma : bar.gamma_per_m) {
    wave.push_back(-gamma * x);
  }
  each_exp(wave);
  return wave;
}

/// sinh(x) / x, entire.
Complex sinhc(Complex x) {
  return std::norm(x) < 1e-6 ? 1.0 + x * x / 6.0 : std::sinh(x) / x;
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

/// tanh(x) / x, entire near 0.
Complex tanhc(Complex x) {
  return std::norm(x) < 1e-6 ? 1.0 - x * x / 3.0 : std::tanh(x) / x;
}

/// Waves from face to face: force and velocity at one are those at the other times
/// (same, force_per_velocity; velocity_per_force, same).
struct Crossing {
  std::vector<Complex> same, force_per_velocity, velocity_per_force;

  explicit Crossing(const Scene& scene) {
    const SpecimenScene& specimen = *scene.specimen;
    const double share = specimen.share_of_stress(0.0);
    std::vector<Complex> material, J;  // without and with lateral inertia
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      // Friction's and lateral inertia's linear parts: stress of the material = share of that
      // measured, less what it takes to move outwards.
      const Complex own = specimen.solid.compliance(scene.s[k], k);
      material.push_back(own * share);
      J.push_back(own * share / (1.0 + own * lateral_stress_Pa(specimen, own, scene.s[k])));
    }
    if (specimen.crossed_sideways && specimen.lateral_inertia_kg_per_m != 0.0) {
      by_halves(scene, material, J);
    } else {
      as_a_layer(scene, J);
    }
  }

 private:
  void as_a_layer(const Scene& scene, const std::vector<Complex>& J) {
    const SpecimenScene& specimen = *scene.specimen;
    const double l = specimen.length_m;
    std::vector<Complex> of;  // wavenumber times length
    for (std::size_t k = 0; k < J.size(); ++k) {
      of.push_back(l * scene.s[k] * std::sqrt(specimen.wave_density_kg_m3 * J[k]));
    }
    std::vector<Complex> exp_of = of;
    each_exp(exp_of);
    for (std::size_t k = 0; k < J.size(); ++k) {
      const Complex x = of[k];
      const Complex S =
          std::norm(x) < 1e-6 ? 1.0 + x * x / 6.0 : 0.5 * (exp_of[k] - 1.0 / exp_of[k]) / x;
      same.push_back(0.5 * (exp_of[k] + 1.0 / exp_of[k]));
      force_per_velocity.push_back(S * scene.s[k] * specimen.wave_density_kg_m3 * l *
                                   specimen.area_m2());
      velocity_per_force.push_back(S * scene.s[k] * l * J[k] / specimen.area_m2());
    }
  }

  /// Faces that move against each other squeeze the section outwards, faces that move alike squeeze
  /// one half and stretch the other, which hardly moves it.
  void by_halves(const Scene& scene, const std::vector<Complex>& material,
                 const std::vector<Complex>& J) {
    const SpecimenScene& specimen = *scene.specimen;
    const double half_m = specimen.length_m / 2.0;
    for (std::size_t k = 0; k < J.size(); ++k) {
      const Complex s = scene.s[k];
      const auto tanhc_of = [&](Complex compliance) {
        return tanhc(half_m * s * std::sqrt(specimen.wave_density_kg_m3 * compliance));
      };
      // Force per velocity of each face.
      const Complex against = specimen.area_m2() / (s * half_m * J[k] * tanhc_of(J[k]));
      const Complex alike =
          s * specimen.wave_density_kg_m3 * half_m * specimen.area_m2() * tanhc_of(material[k]);
      same.push_back((against + alike) / (against - alike));
      force_per_velocity.push_back(2.0 * against * alike / (against - alike));
      velocity_per_force.push_back(2.0 / (against - alike));
    }
  }
};

/// @param round_trip  what comes back through the output bar of a wave that leaves the specimen
Junction junction(const Scene& scene, const Crossing& crossing, std::size_t at,
                  Complex round_trip) {
  const BarScene& in = scene.bars[0];
  const BarScene& out = scene.bars[1];
  const SpecimenScene& specimen = *scene.specimen;
  const Complex s = scene.s[at];
  const double l = specimen.length_m;
  const double area = specimen.area_m2();
  // Force and velocity per unit mean strain of a wave.
  const Complex Z1 =
      in.area_m2 * in.density_kg_m3 * s * s / (in.gamma_per_m[at] * in.gamma_per_m[at]);
  const Complex V1 = s / in.gamma_per_m[at];
  const Complex Z2 = out.area_m2 * out.density_kg_m3 * s * s /
                     (out.gamma_per_m[at] * out.gamma_per_m[at]) * (1.0 + round_trip);
  const Complex V2 = s / out.gamma_per_m[at] * (1.0 - round_trip);
  const Complex C = crossing.same[at];
  const Complex dents = specimen.punching * (indentation_m_per_N(in, specimen, at) +
                                             indentation_m_per_N(out, specimen, at));
  const Complex force_a = Z2 * C + crossing.force_per_velocity[at] * V2;
  const Complex velocity_a = V2 * C + Z2 * (crossing.velocity_per_force[at] + s * dents);
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

/// Mean strain of waves both ways at the end that is struck, per unit source at the reference gauge
/// and, beside a nonlinear specimen, per unit q. Empty where no gauge reads bending.
struct StruckEnd {
  std::vector<Complex> per_source, per_q;
};

StruckEnd struck_end_of_bar(const Scene& scene, std::size_t reference) {
  const BarScene& bar = scene.bars.front();
  StruckEnd end{over(bar, -scene.gauges[reference].position_m), {}};
  const std::vector<Complex> round_trip = over(bar, 2.0 * bar.length_m);
  for (std::size_t k = 0; k < scene.s.size(); ++k) {
    end.per_source[k] *= 1.0 + bar.reflection(k) * round_trip[k];
  }
  return end;
}

/// @param arriving  at the specimen, per unit source
StruckEnd struck_end_of_joint(const Scene& scene, std::size_t reference,
                              const std::vector<Junction>& joints,
                              const std::vector<Complex>& arriving) {
  const BarScene& bar = scene.bars.front();
  const std::vector<Complex> back = over(bar, bar.length_m);
  StruckEnd end{over(bar, -scene.gauges[reference].position_m), {}};
  for (std::size_t k = 0; k < scene.s.size(); ++k) {
    end.per_source[k] += joints[k].reflected * arriving[k] * back[k];
    end.per_q.push_back(joints[k].reflected_q * back[k]);
  }
  return end;
}

StruckEnd set_bar_readings(const Scene& scene, std::size_t reference, Transfers& transfers) {
  const BarScene& bar = scene.bars.front();
  const double x0 = scene.gauges[reference].position_m;
  for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
    const GaugeScene& gauge = scene.gauges[j];
    const double x = gauge.position_m;
    transfers.reading[j] = over(bar, x - x0);
    if (bar.reflects()) {
      const std::vector<Complex> back = over(bar, 2.0 * bar.length_m - x - x0);
      for (std::size_t k = 0; k < scene.s.size(); ++k) {
        transfers.reading[j][k] += bar.reflection(k) * back[k];
      }
    }
    for (std::size_t k = 0; k < scene.s.size(); ++k) {
      transfers.reading[j][k] *= bar.surface_over_mean[k];
    }
  }
  return bends(scene) ? struck_end_of_bar(scene, reference) : StruckEnd{};
}

/// A gauge of the input bar reads the source and what the joint returns; one of the output bar what
/// the joint lets through, and the far end returns of it.
void set_reading(const Scene& scene, std::size_t reference, const std::vector<Junction>& joints,
                 const std::vector<Complex>& arriving, std::size_t j, Transfers& transfers) {
  const GaugeScene& gauge = scene.gauges[j];
  const BarScene& bar = scene.bars[gauge.bar];
  const double x = gauge.position_m;
  const bool on_input = gauge.bar == 0;
  const std::vector<Complex> going =
      over(bar, on_input ? x - scene.gauges[reference].position_m : x);
  std::vector<Complex> back = over(bar, (on_input ? 1.0 : 2.0) * bar.length_m - x);
  for (std::size_t k = 0; k < scene.s.size(); ++k) {
    const Junction& joint = joints[k];
    const Complex there = on_input ? back[k] : going[k] + bar.reflection(k) * back[k];
    const Complex of_source = on_input ? going[k] + joint.reflected * arriving[k] * there
                                       : joint.transmitted * arriving[k] * there;
    const Complex surface = bar.surface_over_mean[k];
    transfers.reading[j][k] = of_source * surface;
    if (!transfers.reading_of_q.empty()) {
      const Complex of_q = (on_input ? joint.reflected_q : joint.transmitted_q) * there;
      transfers.reading_of_q[j][k] = of_q * surface;
    }
  }
}

void set_specimen(const std::vector<Junction>& joints, const std::vector<Complex>& arriving,
                  Transfers& transfers) {
  for (auto* spectrum :
       {&transfers.stress, &transfers.stress_of_q, &transfers.strain, &transfers.strain_of_q}) {
    spectrum->resize(joints.size());
  }
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const Junction& joint = joints[k];
    transfers.stress[k] = joint.stress_per_transmitted * joint.transmitted * arriving[k];
    transfers.stress_of_q[k] = joint.stress_per_transmitted * joint.transmitted_q;
    transfers.strain[k] = joint.strain * arriving[k];
    transfers.strain_of_q[k] = joint.strain_q;
  }
}

StruckEnd set_shpb_readings(const Scene& scene, std::size_t reference, Transfers& transfers) {
  const BarScene& in = scene.bars[0];
  const BarScene& out = scene.bars[1];
  const std::vector<Complex> round_trip = over(out, 2.0 * out.length_m);
  const Crossing crossing(scene);
  std::vector<Junction> joints;
  joints.reserve(scene.s.size());
  for (std::size_t k = 0; k < scene.s.size(); ++k) {
    joints.push_back(junction(scene, crossing, k, out.reflection(k) * round_trip[k]));
  }
  const std::vector<Complex> arriving = over(in, in.length_m - scene.gauges[reference].position_m);
  if (scene.specimen->nonlinear()) {
    transfers.reading_of_q.assign(scene.gauges.size(), Transfers::Spectrum(scene.s.size()));
    set_specimen(joints, arriving, transfers);
  }
  for (std::size_t j = 0; j < scene.gauges.size(); ++j) {
    set_reading(scene, reference, joints, arriving, j, transfers);
  }
  return bends(scene) ? struck_end_of_joint(scene, reference, joints, arriving) : StruckEnd{};
}

/// Bending, the sensors' own factors, then what neighbours pick up.
void pass_sensors(const Scene& scene, std::size_t reference, const StruckEnd& end,
                  Transfers& transfers) {
  if (!end.per_source.empty()) {
    add_bending(scene, end.per_source, transfers.reading);
  }
  if (!end.per_q.empty() && !transfers.reading_of_q.empty()) {
    add_bending(scene, end.per_q, transfers.reading_of_q);
  }
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
  const double size = std::sqrt(std::norm(factor));
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
  const StruckEnd end = scene.bars.size() == 1 ? set_bar_readings(scene, reference, transfers)
                                               : set_shpb_readings(scene, reference, transfers);
  pass_sensors(scene, reference, end, transfers);
  return transfers;
}

}  // namespace kolsky

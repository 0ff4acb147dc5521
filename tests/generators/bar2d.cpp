#include "tests/generators/bar2d.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/generators/interpolation.hpp"
#include "tests/generators/spectral.hpp"

namespace kolsky::testing {

namespace {

constexpr std::size_t kS = 4;  // radial points
constexpr std::size_t kZ = 7;  // axial points of an element
constexpr std::size_t kOrder = kZ - 1;
using Plane = std::array<double, kS>;
using Block = std::array<Plane, kZ>;
// Strains with their common powers of r taken out: rr, theta, zz, shear/r.
using Strains = std::array<Block, 4>;

class SolidBar {
 public:
  SolidBar(const SolidBarProblem& problem, double element_m, std::size_t elements);

  [[nodiscard]] double longest_step() const;
  void advance(double time_s, double step_s, const UnitSource& source, std::size_t active);
  [[nodiscard]] double surface_strain(double z_m) const;

 private:
  struct Wave {
    std::vector<Plane> value, speed, value_store, speed_store, force;
    void resize(std::size_t planes);
  };
  void element_forces(std::size_t element, double A, double B, double step_s);
  void strains_of(std::size_t element, Strains& strains) const;
  void return_forces(std::size_t element, const Strains& stresses);
  void move(Wave& wave, const std::vector<Plane>& mass, double A, double B, double step_s,
            std::size_t planes);

  double element_m_;
  std::size_t elements_;
  SpectralRule axial_, radial_;
  std::array<std::array<double, kZ>, kZ> dz_{};
  std::array<std::array<double, kS>, kS> ds_{};
  Plane s_{};     // r^2
  Plane area_{};  // weight of a point of the section, m2
  std::array<double, kZ> length_{};
  double glassy_, lame_, shear_;
  std::vector<KelvinElement> chain_;
  Wave q_, p_;
  std::vector<Plane> mass_q_, mass_p_;
  std::vector<std::vector<Strains>> viscous_, viscous_store_;  // [element][chain]
  bool frozen_ = false;
};

void SolidBar::Wave::resize(std::size_t planes) {
  for (auto* field : {&value, &speed, &value_store, &speed_store, &force}) {
    field->assign(planes, Plane{});
  }
}

SolidBar::SolidBar(const SolidBarProblem& problem, double element_m, std::size_t elements)
    : element_m_(element_m),
      elements_(elements),
      axial_(lobatto(kZ)),
      radial_(radau(kS)),
      glassy_(problem.material.glassy_Pa),
      chain_(problem.material.elements) {
  const double nu = problem.poisson_ratio;
  lame_ = glassy_ * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  shear_ = glassy_ / (2.0 * (1.0 + nu));
  const double a2 = problem.radius_m * problem.radius_m;
  for (std::size_t i = 0; i < kS; ++i) {
    s_[i] = 0.5 * a2 * (1.0 + radial_.node[i]);
    area_[i] = std::numbers::pi * 0.5 * a2 * radial_.weight[i];
    for (std::size_t j = 0; j < kS; ++j) {
      ds_[i][j] = radial_.derivative[i][j] * 2.0 / a2;
    }
  }
  for (std::size_t i = 0; i < kZ; ++i) {
    length_[i] = 0.5 * element_m * axial_.weight[i];
    for (std::size_t j = 0; j < kZ; ++j) {
      dz_[i][j] = axial_.derivative[i][j] * 2.0 / element_m;
    }
  }
  const std::size_t planes = elements * kOrder + 1;
  q_.resize(planes);
  p_.resize(planes);
  mass_q_.assign(planes, Plane{});
  mass_p_.assign(planes, Plane{});
  for (std::size_t e = 0; e < elements; ++e) {
    for (std::size_t k = 0; k < kZ; ++k) {
      for (std::size_t i = 0; i < kS; ++i) {
        const double mass = problem.density_kg_m3 * area_[i] * length_[k];
        mass_q_[e * kOrder + k][i] += mass;
        mass_p_[e * kOrder + k][i] += mass * s_[i];
      }
    }
  }
  viscous_.assign(elements, std::vector<Strains>(chain_.size(), Strains{}));
  viscous_store_ = viscous_;
}

void SolidBar::strains_of(std::size_t element, Strains& strains) const {
  const Plane* const q = q_.value.data() + element * kOrder;
  const Plane* const p = p_.value.data() + element * kOrder;
  for (std::size_t k = 0; k < kZ; ++k) {
    Plane q_z{};
    Plane p_z{};
    for (std::size_t m = 0; m < kZ; ++m) {
      for (std::size_t i = 0; i < kS; ++i) {
        q_z[i] += dz_[k][m] * q[m][i];
        p_z[i] += dz_[k][m] * p[m][i];
      }
    }
    for (std::size_t i = 0; i < kS; ++i) {
      double q_s = 0.0;
      double p_s = 0.0;
      for (std::size_t j = 0; j < kS; ++j) {
        q_s += ds_[i][j] * q[k][j];
        p_s += ds_[i][j] * p[k][j];
      }
      strains[0][k][i] = p[k][i] + 2.0 * s_[i] * p_s;
      strains[1][k][i] = p[k][i];
      strains[2][k][i] = q_z[i];
      strains[3][k][i] = p_z[i] + 2.0 * q_s;
    }
  }
}

void SolidBar::return_forces(std::size_t element, const Strains& stresses) {
  Plane* const fq = q_.force.data() + element * kOrder;
  Plane* const fp = p_.force.data() + element * kOrder;
  for (std::size_t k = 0; k < kZ; ++k) {
    Plane axial;
    Plane shear;
    Plane q_s;
    Plane p_s;
    for (std::size_t i = 0; i < kS; ++i) {
      const double volume = area_[i] * length_[k];
      axial[i] = volume * stresses[2][k][i];
      shear[i] = volume * s_[i] * stresses[3][k][i];
      q_s[i] = 2.0 * shear[i];
      p_s[i] = 2.0 * s_[i] * volume * stresses[0][k][i];
      fp[k][i] -= volume * (stresses[0][k][i] + stresses[1][k][i]);
    }
    for (std::size_t j = 0; j < kS; ++j) {
      for (std::size_t i = 0; i < kS; ++i) {
        fq[k][j] -= ds_[i][j] * q_s[i];
        fp[k][j] -= ds_[i][j] * p_s[i];
      }
    }
    for (std::size_t m = 0; m < kZ; ++m) {
      for (std::size_t i = 0; i < kS; ++i) {
        fq[m][i] -= dz_[k][m] * axial[i];
        fp[m][i] -= dz_[k][m] * shear[i];
      }
    }
  }
}

void SolidBar::element_forces(std::size_t element, double A, double B, double step_s) {
  Strains sprung;
  strains_of(element, sprung);
  for (const Strains& strains : viscous_[element]) {
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t k = 0; k < kZ; ++k) {
        for (std::size_t i = 0; i < kS; ++i) {
          sprung[c][k][i] -= strains[c][k][i];
        }
      }
    }
  }
  if (!frozen_) {
    for (std::size_t n = 0; n < chain_.size(); ++n) {
      const double fluidity = step_s / chain_[n].viscosity_Pa_s;
      Strains& strains = viscous_[element][n];
      Strains& store = viscous_store_[element][n];
      for (std::size_t c = 0; c < 4; ++c) {
        for (std::size_t k = 0; k < kZ; ++k) {
          for (std::size_t i = 0; i < kS; ++i) {
            const double drive =
                glassy_ * sprung[c][k][i] - chain_[n].stiffness_Pa * strains[c][k][i];
            store[c][k][i] = A * store[c][k][i] + fluidity * drive;
            strains[c][k][i] += B * store[c][k][i];
          }
        }
      }
    }
  }
  for (std::size_t k = 0; k < kZ; ++k) {
    for (std::size_t i = 0; i < kS; ++i) {
      const double bulk = lame_ * (sprung[0][k][i] + sprung[1][k][i] + sprung[2][k][i]);
      for (std::size_t c = 0; c < 3; ++c) {
        sprung[c][k][i] = bulk + 2.0 * shear_ * sprung[c][k][i];
      }
      sprung[3][k][i] *= shear_;
    }
  }
  return_forces(element, sprung);
}

void SolidBar::move(Wave& wave, const std::vector<Plane>& mass, double A, double B, double step_s,
                    std::size_t planes) {
  for (std::size_t n = 0; n < planes; ++n) {
    for (std::size_t i = 0; i < kS; ++i) {
      wave.value_store[n][i] = A * wave.value_store[n][i] + step_s * wave.speed[n][i];
      wave.speed_store[n][i] = A * wave.speed_store[n][i] + step_s * wave.force[n][i] / mass[n][i];
      wave.value[n][i] += B * wave.value_store[n][i];
      wave.speed[n][i] += B * wave.speed_store[n][i];
    }
  }
}

void SolidBar::advance(double time_s, double step_s, const UnitSource& source, std::size_t active) {
  using RK = LowStorageRungeKutta;
  const std::size_t elements = std::min(active, elements_);
  // Beyond the last active element nothing moves: its far plane stays where it is.
  const std::size_t planes = elements * kOrder + (elements == elements_ ? 1 : 0);
  for (std::size_t stage = 0; stage < RK::kA.size(); ++stage) {
    std::fill_n(q_.force.begin(), elements * kOrder + 1, Plane{});
    std::fill_n(p_.force.begin(), elements * kOrder + 1, Plane{});
    const double pressure_Pa = source.at(time_s + RK::kC[stage] * step_s);
    for (std::size_t i = 0; i < kS; ++i) {
      q_.force[0][i] += area_[i] * pressure_Pa;
    }
    for (std::size_t e = 0; e < elements; ++e) {
      element_forces(e, RK::kA[stage], RK::kB[stage], step_s);
    }
    move(q_, mass_q_, RK::kA[stage], RK::kB[stage], step_s, planes);
    move(p_, mass_p_, RK::kA[stage], RK::kB[stage], step_s, planes);
  }
}

double SolidBar::surface_strain(double z_m) const {
  const auto element = std::min(static_cast<std::size_t>(z_m / element_m_), elements_ - 1);
  const double x = 2.0 * (z_m / element_m_ - static_cast<double>(element)) - 1.0;
  const std::vector<double> slopes = lagrange_slopes(axial_, x);
  double strain = 0.0;
  for (std::size_t m = 0; m < kZ; ++m) {
    strain -= slopes[m] * 2.0 / element_m_ * q_.value[element * kOrder + m][kS - 1];
  }
  return strain;
}

// The fastest oscillation of the elements, by power iteration: meant for a short bar.
double SolidBar::longest_step() const {
  SolidBar probe = *this;
  probe.frozen_ = true;
  double largest = 0.0;
  for (std::size_t n = 0; n < probe.q_.value.size(); ++n) {
    for (std::size_t i = 0; i < kS; ++i) {
      probe.q_.value[n][i] = static_cast<double>((n * 7 + i * 3) % 11) - 5.0;
      probe.p_.value[n][i] = (static_cast<double>((n * 5 + i * 2) % 13) - 6.0) / std::sqrt(s_[i]);
    }
  }
  for (int round = 0; round < 150; ++round) {
    std::ranges::fill(probe.q_.force, Plane{});
    std::ranges::fill(probe.p_.force, Plane{});
    for (std::size_t e = 0; e < elements_; ++e) {
      probe.element_forces(e, 0.0, 0.0, 0.0);
    }
    double norm = 0.0;
    double energy = 0.0;
    for (std::size_t n = 0; n < probe.q_.value.size(); ++n) {
      for (std::size_t i = 0; i < kS; ++i) {
        energy -= probe.q_.value[n][i] * probe.q_.force[n][i] +
                  probe.p_.value[n][i] * probe.p_.force[n][i];
        norm += mass_q_[n][i] * probe.q_.value[n][i] * probe.q_.value[n][i] +
                mass_p_[n][i] * probe.p_.value[n][i] * probe.p_.value[n][i];
      }
    }
    largest = energy / norm;
    const double scale = 1.0 / std::sqrt(norm);
    for (std::size_t n = 0; n < probe.q_.value.size(); ++n) {
      for (std::size_t i = 0; i < kS; ++i) {
        probe.q_.value[n][i] = -scale * probe.q_.force[n][i] / mass_q_[n][i] / largest;
        probe.p_.value[n][i] = -scale * probe.p_.force[n][i] / mass_p_[n][i] / largest;
      }
    }
  }
  return LowStorageRungeKutta::kImaginaryReach / std::sqrt(largest * 1.03);
}

// The slowest waves of the first mode travel at half speed; then a three-element bar forgets within
// some retardation times.
double horizon(const SolidBarProblem& problem, const UnitSource& source, double c) {
  const double last_m = *std::ranges::max_element(problem.stations_m);
  if (problem.free_end_m) {
    return problem.window_s;
  }
  double slowest_s = 10e-6;
  for (const KelvinElement& element : problem.material.elements) {
    if (element.stiffness_Pa == 0.0) {
      return problem.window_s;
    }
    slowest_s = std::max(slowest_s, element.viscosity_Pa_s / element.stiffness_Pa);
  }
  return std::min(problem.window_s, 2.2 * last_m / c + source.duration_s() + 18.0 * slowest_s);
}

KelvinChain without_the_fastest(const KelvinChain& chain, double least_s) {
  KelvinChain kept{chain.glassy_Pa, {}};
  for (const KelvinElement& element : chain.elements) {
    if (element.stiffness_Pa > 0.0 && element.viscosity_Pa_s / element.stiffness_Pa < least_s) {
      kept.glassy_Pa = 1.0 / (1.0 / kept.glassy_Pa + 1.0 / element.stiffness_Pa);
    } else {
      kept.elements.push_back(element);
    }
  }
  return kept;
}

}  // namespace

Responses solid_bar_response(const SolidBarProblem& asked, const UnitSource& source,
                             const SolidBarNumerics& numerics) {
  SolidBarProblem problem = asked;
  problem.material = without_the_fastest(asked.material, 0.3e-6);
  const double nu = problem.poisson_ratio;
  const double c = std::sqrt(problem.material.glassy_Pa / problem.density_kg_m3);
  const double fastest = c * std::sqrt((1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)));
  const double last_m = *std::ranges::max_element(problem.stations_m);
  const double end_s = horizon(problem, source, c);
  double element_m = numerics.element_radii * problem.radius_m;
  // Where an infinite bar is cut must not be heard of: part of a wave runs ahead of the bar's
  // speed, at the solid's, and would come back.
  const double beyond_m = 15.0 * problem.radius_m;
  double reach_m = 0.5 * (fastest * end_s + last_m) + beyond_m;
  if (problem.free_end_m) {
    reach_m = *problem.free_end_m;
    element_m = reach_m / std::round(reach_m / element_m);
  }
  const auto elements = static_cast<std::size_t>(std::ceil(reach_m / element_m - 1e-9));
  const double step_bound = numerics.step_share * SolidBar(problem, element_m, 5).longest_step();
  const double divisions = std::ceil(numerics.output_step_s / step_bound);
  const double step_s = numerics.output_step_s / divisions;

  SolidBar bar(problem, element_m, elements);
  const auto count = static_cast<std::size_t>(problem.window_s / numerics.output_step_s) + 2;
  Responses out{numerics.output_step_s, std::vector<std::vector<double>>(
                                            problem.stations_m.size(), std::vector<double>(count))};
  for (std::size_t n = 1; n < count; ++n) {
    const double begin_s = static_cast<double>(n - 1) * numerics.output_step_s;
    if (begin_s > end_s) {
      break;
    }
    // Waves have come so far; and what is farther than this cannot get back in time.
    const double reached_m = fastest * (begin_s + numerics.output_step_s) + beyond_m;
    const double needed_m = last_m + fastest * (end_s - begin_s) + beyond_m;
    const auto active =
        problem.free_end_m
            ? static_cast<std::size_t>(reached_m / element_m) + 1
            : static_cast<std::size_t>(std::min(reached_m, needed_m) / element_m) + 1;
    for (int i = 0; i < static_cast<int>(divisions); ++i) {
      bar.advance(begin_s + i * step_s, step_s, source, active);
    }
    for (std::size_t g = 0; g < out.strain.size(); ++g) {
      out.strain[g][n] = bar.surface_strain(problem.stations_m[g]);
    }
  }
  return out;
}

}  // namespace kolsky::testing

#include "drivers/simulated/rod.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace kolsky {

namespace {

std::size_t cells_of(const RodShape& shape, double time_step_s) {
  const double most = shape.length_m / (shape.material.front_speed_m_per_s() * time_step_s);
  if (!(most >= 1.0)) {
    throw std::invalid_argument("the time step is longer than a wave takes through the rod");
  }
  // A step that fits exactly must not lose a cell to rounding.
  return static_cast<std::size_t>(most * (1.0 + 1e-12));
}

}  // namespace

double RodMaterial::front_speed_m_per_s() const {
  return std::sqrt(E1_Pa / density_kg_m3);
}

Rod::Rod(const RodShape& shape, double time_step_s)
    : cell_m_(shape.length_m / static_cast<double>(cells_of(shape, time_step_s))),
      step_s_(time_step_s),
      E1_Pa_(shape.material.E1_Pa),
      elastic_(shape.material.elastic()),
      area_m2_(shape.area_m2),
      node_mass_kg_(shape.material.density_kg_m3 * shape.area_m2 * cell_m_),
      end_mass_kg_(node_mass_kg_ / 2.0),
      step_per_end_mass_(time_step_s / end_mass_kg_),
      keep_(0.0),
      from_before_(0.0),
      from_after_(0.0),
      strain_(cells_of(shape, time_step_s), 0.0),
      internal_(strain_.size(), 0.0),
      stress_(strain_.size(), 0.0),
      velocity_(strain_.size() + 1, 0.0) {
  if (elastic_) {
    return;
  }
  const RodMaterial& m = shape.material;
  if (!m.plain()) {
    prepare_chain(m);
    return;
  }
  const double x = (m.E1_Pa + m.E2_Pa) / m.eta2_Pa_s * time_step_s;
  const double settled = m.E1_Pa / (m.E1_Pa + m.E2_Pa);
  const double mean_decay = -std::expm1(-x) / x;
  keep_ = std::exp(-x);
  from_before_ = settled * (mean_decay - keep_);
  from_after_ = settled * (1.0 - mean_decay);
}

void Rod::advance_velocities() {
  const double per_inner_mass = step_s_ * area_m2_ / node_mass_kg_;
  const std::size_t last = strain_.size();
  velocity_[0] -= stress_[0] * area_m2_ * step_per_end_mass_;
  velocity_[last] += stress_[last - 1] * area_m2_ * step_per_end_mass_;
  const double* const stress = stress_.data();
  double* const velocity = velocity_.data();
  for (std::size_t i = 1; i < last; ++i) {
    velocity[i] += (stress[i - 1] - stress[i]) * per_inner_mass;
  }
}

void Rod::prepare_chain(const RodMaterial& material) {
  std::vector<RodRelaxation> all = material.relaxations;
  all.push_back({1.0 / material.E2_Pa, material.eta2_Pa_s / material.E2_Pa});
  for (const RodRelaxation& own : all) {
    const double half = 0.5 * step_s_ / own.tau_s;
    chain_.push_back({(1.0 - half) / (1.0 + half), own.D_per_Pa * half / (1.0 + half),
                      std::vector<double>(strain_.size(), 0.0)});
  }
  if (material.phi_per_Pa_s != 0.0) {
    chain_.push_back(
        {1.0, 0.5 * step_s_ * material.phi_per_Pa_s, std::vector<double>(strain_.size(), 0.0)});
  }
}

void Rod::advance_strains() {
  if (elastic_) {
    advance_elastic_strains();
  } else if (!chain_.empty()) {
    advance_chain_strains();
  } else {
    advance_viscous_strains();
  }
}

void Rod::advance_elastic_strains() {
  const double per_cell = step_s_ / cell_m_;
  for (std::size_t i = 0; i < strain_.size(); ++i) {
    strain_[i] += (velocity_[i] - velocity_[i + 1]) * per_cell;
    stress_[i] = E1_Pa_ * strain_[i];
  }
}

void Rod::advance_viscous_strains() {
  const double per_cell = step_s_ / cell_m_;
  const double keep = keep_;
  const double from_before = from_before_;
  const double from_after = from_after_;
  const double modulus = E1_Pa_;
  const double* const velocity = velocity_.data();
  double* const strain = strain_.data();
  double* const internal = internal_.data();
  double* const stress = stress_.data();
  const std::size_t cells = strain_.size();
  for (std::size_t i = 0; i < cells; ++i) {
    const double before = strain[i];
    const double after = before + (velocity[i] - velocity[i + 1]) * per_cell;
    const double q = keep * internal[i] + from_before * before + from_after * after;
    strain[i] = after;
    internal[i] = q;
    stress[i] = modulus * (after - q);
  }
}

void Rod::advance_chain_strains() {
  const double per_cell = step_s_ / cell_m_;
  double taken = 0.0;
  for (const Element& element : chain_) {
    taken += element.take;
  }
  const double answer = 1.0 / (1.0 / E1_Pa_ + taken);
  for (std::size_t i = 0; i < strain_.size(); ++i) {
    strain_[i] += (velocity_[i] - velocity_[i + 1]) * per_cell;
    const double before = stress_[i];
    double held = 0.0;
    for (const Element& element : chain_) {
      held += element.keep * element.strain[i] + element.take * before;
    }
    stress_[i] = (strain_[i] - held) * answer;
    for (Element& element : chain_) {
      element.strain[i] = element.keep * element.strain[i] + element.take * (before + stress_[i]);
    }
  }
}

double Rod::strain_at(double position_m) const {
  const double place = position_m / cell_m_ - 0.5;  // in cells, 0 at the first one's centre
  const auto cells_between = static_cast<double>(cells() - 3);
  const double left = std::clamp(std::floor(place), 1.0, cells_between);
  const double t = place - left;
  const double* const e = &strain_[static_cast<std::size_t>(left) - 1];
  return -t * (t - 1.0) * (t - 2.0) / 6.0 * e[0] + (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0 * e[1] -
         (t + 1.0) * t * (t - 2.0) / 2.0 * e[2] + (t + 1.0) * t * (t - 1.0) / 6.0 * e[3];
}

double Rod::momentum_kg_m_per_s() const {
  const double inner = std::accumulate(velocity_.begin() + 1, velocity_.end() - 1, 0.0);
  return node_mass_kg_ * inner + end_mass_kg_ * (velocity_.front() + velocity_.back());
}

}  // namespace kolsky

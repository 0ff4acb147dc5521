#include "processing/impact/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "processing/impact/lanczos.hpp"
#include "processing/impact/quadrilateral.hpp"

namespace kolsky::impact {
namespace {

std::size_t padded(std::size_t count) {
  return (count + kMostLanes - 1) / kMostLanes * kMostLanes;
}

// Numbers without a pattern where `weights` is not zero; the same each time.
std::vector<double> random_where(const std::vector<double>& weights) {
  unsigned state = 12345;
  std::vector<double> values(weights.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    state = state * 1664525U + 1013904223U;
    const double value = static_cast<double>(state >> 8U) / static_cast<double>(1U << 24U) - 0.5;
    values[i] = weights[i] > 0.0 ? value : 0.0;
  }
  return values;
}

}  // namespace

Body::Body(Mesh mesh, std::vector<Solid> solids, const ElementKernel& kernel)
    : mesh_(std::move(mesh)), solids_(std::move(solids)), kernel_(&kernel) {
  const std::size_t nodes = mesh_.R_m.size();
  for (std::vector<double>* array :
       {&ur_, &uz_, &vr_, &vz_, &fr_, &fz_, &mass_, &by_mass_r_, &by_mass_z_, &kept_r_, &kept_z_}) {
    array->assign(nodes, 0.0);
  }
  contributions_.assign(kForceArrays * nodes, Real{});
  volume_m3_.assign(solids_.size(), 0.0);
  ranges_.resize(mesh_.regions.size());
  for (std::size_t i = 0; i < ranges_.size(); ++i) {
    ranges_[i].region = mesh_.regions[i];
    measure(ranges_[i]);
    spread_mass(ranges_[i], solids_[ranges_[i].region.solid].density_kg_m3);
  }
  for (const Tie& tie : mesh_.ties) {
    mass_[tie.a] = mass_[tie.b] = mass_[tie.a] + mass_[tie.b];
  }
  for (std::size_t n = 0; n < nodes; ++n) {
    by_mass_r_[n] = by_mass_z_[n] = mass_[n] > 0.0 ? 1.0 / mass_[n] : 0.0;
  }
  for (const std::size_t n : mesh_.axis) {
    by_mass_r_[n] = 0.0;
  }
}

void Body::measure(Range& range) {
  const Block& block = mesh_.blocks[range.region.block];
  const Solid& solid = solids_[range.region.solid];
  const std::size_t stride = block.stride();
  const std::size_t count = range.region.rows * stride;
  const std::size_t pitch = padded(count);
  range.geometry.assign(kGeometryArrays * pitch, Real{});
  range.state.assign(kStatePerBranch * solid.arms.size() * pitch, Real{});
  for (std::size_t j = 0; j < range.region.rows; ++j) {
    for (std::size_t i = 0; i < block.columns; ++i) {
      const auto nodes = corners(block, i, range.region.first_row + j);
      Real* const element = range.geometry.data() + j * stride + i;
      std::array<double, 4> share{};
      double volume = 0.0;
      for (std::size_t g = 0; g < 4; ++g) {
        const Jacobian J = jacobian_at(mesh_, nodes, gauss_xi(g), gauss_eta(g));
        const double determinant = J.determinant();
        share[g] = 0.25 * 2.0 * std::numbers::pi * J.R * std::abs(determinant);
        Real* const at = element + kGeometryPerPoint * g * pitch;
        at[0] = static_cast<Real>(J.Z_eta / determinant);
        at[pitch] = static_cast<Real>(-J.R_eta / determinant);
        at[2 * pitch] = static_cast<Real>(-J.Z_xi / determinant);
        at[3 * pitch] = static_cast<Real>(J.R_xi / determinant);
        at[5 * pitch] = static_cast<Real>(1.0 / J.R);
        volume += share[g];
      }
      for (std::size_t g = 0; g < 4; ++g) {
        element[(kGeometryPerPoint * g + 4) * pitch] = static_cast<Real>(share[g] / volume);
      }
      element[(kGeometryArrays - 1) * pitch] = static_cast<Real>(volume);
      volume_m3_[range.region.solid] += volume;
    }
  }
  const std::size_t first = block.node(0, range.region.first_row);
  ElementRange& e = range.elements;
  e.count = count;
  e.stride = stride;
  e.pitch = pitch;
  e.force_pitch = mesh_.R_m.size();
  e.radial = ur_.data() + first;
  e.axial = uz_.data() + first;
  e.geometry = range.geometry.data();
  e.state = range.state.data();
  e.force = contributions_.data() + first;
  e.shear_Pa = static_cast<Real>(2.0 * solid.shear_relaxed_Pa);
  e.bulk_Pa = static_cast<Real>(solid.bulk_relaxed_Pa);
  e.nonlinearity = static_cast<Real>(solid.nonlinearity);
  e.cauchy = solid.law == FiniteStrain::cauchy ? 1.0F : 0.0F;
  e.branches = static_cast<int>(solid.arms.size());
  range.wave_speed_squared = solid.fastest_wave_m_per_s() * solid.fastest_wave_m_per_s();
  for (std::size_t b = 0; b < solid.arms.size(); ++b) {
    const SolidArm& arm = solid.arms[b];
    e.branch[b].shear_Pa = static_cast<Real>(2.0 * arm.shear_Pa);
    e.branch[b].bulk_Pa = static_cast<Real>(arm.bulk_Pa);
    e.branch[b].rate_per_s = static_cast<Real>(1.0 / arm.time_s);
  }
}

void Body::spread_mass(const Range& range, double density_kg_m3) {
  const Block& block = mesh_.blocks[range.region.block];
  for (std::size_t j = 0; j < range.region.rows; ++j) {
    for (std::size_t i = 0; i < block.columns; ++i) {
      const auto nodes = corners(block, i, range.region.first_row + j);
      const std::size_t pitch = range.elements.pitch;
      const Real* const element = range.geometry.data() + j * block.stride() + i;
      const double mass = density_kg_m3 * element[(kGeometryArrays - 1) * pitch];
      for (std::size_t g = 0; g < 4; ++g) {
        const double share = mass * element[(kGeometryPerPoint * g + 4) * pitch];
        const auto N = shape(gauss_xi(g), gauss_eta(g));
        for (std::size_t a = 0; a < 4; ++a) {
          mass_[nodes[a]] += N[a] * share;
        }
      }
    }
  }
}

void Body::set_steps(double now_s, double next_s) {
  for (Range& range : ranges_) {
    for (int b = 0; b < range.elements.branches; ++b) {
      BranchStep& step = range.elements.branch[b];
      const double now = now_s * static_cast<double>(step.rate_per_s);
      const double next = next_s * static_cast<double>(step.rate_per_s);
      step.weight_now = static_cast<Real>(now > 0.0 ? 1.0 + std::expm1(-now) / now : 0.0);
      step.loss = static_cast<Real>(-std::expm1(-next));
      step.weight_next =
          static_cast<Real>(next > 0.0 ? -std::expm1(-next) / next - std::exp(-next) : 0.0);
    }
  }
}

ElementSums Body::find_forces(bool survey) {
  ElementSums total;
  if (survey) {
    steepness_ = 0.0;
  }
  for (const Range& range : ranges_) {
    if (!survey) {
      kernel_->advance(range.elements, total);
      continue;
    }
    ElementSums sums;
    kernel_->survey(range.elements, sums);
    total.dissipated_W += sums.dissipated_W;
    total.stored_J += sums.stored_J;
    total.least_area_ratio = std::min(total.least_area_ratio, sums.least_area_ratio);
    steepness_ = std::max(steepness_, sums.steepest_per_m2 * range.wave_speed_squared);
  }
  for (const Block& block : mesh_.blocks) {
    gather(block);
  }
  return total;
}

void Body::gather(const Block& block) {
  const std::size_t pitch = mesh_.R_m.size();
  const std::size_t first = block.first_node;
  const Real* const contributions = contributions_.data() + first;
  const std::size_t of_one_direction = kForceArrays / 2 * pitch;
  kernel_->gather({block.nodes(), block.stride(), contributions, pitch, fr_.data() + first});
  kernel_->gather(
      {block.nodes(), block.stride(), contributions + of_one_direction, pitch, fz_.data() + first});
}

void Body::keep_forces() {
  std::copy(fr_.begin(), fr_.end(), kept_r_.begin());
  std::copy(fz_.begin(), fz_.end(), kept_z_.begin());
}

double Body::kept_power() const {
  return dot(kept_r_, vr_) + dot(kept_z_, vz_);
}

void Body::join_ties() {
  for (const Tie& tie : mesh_.ties) {
    fr_[tie.a] = fr_[tie.b] = fr_[tie.a] + fr_[tie.b];
    fz_[tie.a] = fz_[tie.b] = fz_[tie.a] + fz_[tie.b];
  }
}

void Body::advance(double velocity_step_s, double step_s) {
  const std::size_t nodes = ur_.size();
  kernel_->move({nodes, fr_.data(), by_mass_r_.data(), vr_.data(), ur_.data()}, velocity_step_s,
                step_s);
  kernel_->move({nodes, fz_.data(), by_mass_z_.data(), vz_.data(), uz_.data()}, velocity_step_s,
                step_s);
}

void Body::place(std::span<const double> radial_m, std::span<const double> axial_m) {
  // Copied, not swapped: the ranges point into the arrays.
  std::copy(radial_m.begin(), radial_m.end(), ur_.begin());
  std::copy(axial_m.begin(), axial_m.end(), uz_.begin());
}

void Body::set_velocity(std::span<const double> radial_m_per_s,
                        std::span<const double> axial_m_per_s) {
  std::copy(radial_m_per_s.begin(), radial_m_per_s.end(), vr_.begin());
  std::copy(axial_m_per_s.begin(), axial_m_per_s.end(), vz_.begin());
}

void Body::set_axial_velocity(double velocity_m_per_s) {
  for (std::size_t n = 0; n < vz_.size(); ++n) {
    vz_[n] = mass_[n] > 0.0 ? velocity_m_per_s : 0.0;
  }
}

void Body::forget() {
  for (Range& range : ranges_) {
    std::fill(range.state.begin(), range.state.end(), Real{});
  }
  for (std::vector<double>* array : {&ur_, &uz_, &fr_, &fz_}) {
    std::fill(array->begin(), array->end(), 0.0);
  }
}

double Body::highest_frequency(const std::vector<Spring>& springs, int steps) {
  // Arms that do not yield: the instantaneous moduli.
  for (Range& range : ranges_) {
    for (int b = 0; b < range.elements.branches; ++b) {
      BranchStep& step = range.elements.branch[b];
      step.weight_now = step.weight_next = 0.0F;
      step.loss = 1.0F;
    }
  }
  // In q = M^(1/2) u, radial then axial. Tied nodes share one unknown: the copy follows.
  const std::size_t nodes = ur_.size();
  std::vector<double> root(2 * nodes);
  for (std::size_t n = 0; n < nodes; ++n) {
    root[n] = std::sqrt(by_mass_r_[n]);
    root[nodes + n] = std::sqrt(by_mass_z_[n]);
  }
  for (const Tie& tie : mesh_.ties) {
    root[tie.b] = root[nodes + tie.b] = 0.0;
  }
  const double longest_m = *std::max_element(mesh_.R_m.begin(), mesh_.R_m.end());
  const double small = 1e-10 * longest_m * std::sqrt(mass_kg());
  const double value = largest_eigenvalue(
      random_where(root), steps, [&](std::span<const double> q, std::span<double> product) {
        for (std::size_t n = 0; n < nodes; ++n) {
          ur_[n] = small * root[n] * q[n];
          uz_[n] = small * root[nodes + n] * q[nodes + n];
        }
        for (const Tie& tie : mesh_.ties) {
          ur_[tie.b] = ur_[tie.a];
          uz_[tie.b] = uz_[tie.a];
        }
        (void)find_forces(false);
        for (const Spring& spring : springs) {
          push(spring.node, -spring.stiffness_N_per_m * ur_[spring.node],
               -spring.stiffness_N_per_m * uz_[spring.node]);
        }
        join_ties();
        for (std::size_t n = 0; n < nodes; ++n) {
          product[n] = -fr_[n] * root[n] / small;
          product[nodes + n] = -fz_[n] * root[nodes + n] / small;
        }
      });
  forget();
  return std::sqrt(value);
}

double Body::mass_kg() const {
  double total = 0.0;
  for (const double mass : mass_) {
    total += mass;
  }
  for (const Tie& tie : mesh_.ties) {
    total -= mass_[tie.b];
  }
  return total;
}

double Body::axial_momentum() const {
  double total = 0.0;
  for (std::size_t n = 0; n < vz_.size(); ++n) {
    total += mass_[n] * vz_[n];
  }
  for (const Tie& tie : mesh_.ties) {
    total -= mass_[tie.b] * vz_[tie.b];
  }
  return total;
}

double Body::kinetic_energy(double velocity_step_s) const {
  const auto of = [&](std::size_t n) {
    const double r = vr_[n] * (vr_[n] + velocity_step_s * fr_[n] * by_mass_r_[n]);
    const double z = vz_[n] * (vz_[n] + velocity_step_s * fz_[n] * by_mass_z_[n]);
    return 0.5 * mass_[n] * (r + z);
  };
  double total = 0.0;
  for (std::size_t n = 0; n < vz_.size(); ++n) {
    total += of(n);
  }
  for (const Tie& tie : mesh_.ties) {
    total -= of(tie.b);
  }
  return total;
}

}  // namespace kolsky::impact

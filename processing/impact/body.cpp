#include "processing/impact/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <utility>

namespace kolsky::impact {
namespace {

constexpr double kGaussLow = 0.21132486540518712;  // (1 - 1/sqrt(3))/2
constexpr double kGaussHigh = 0.78867513459481288;

std::size_t padded(std::size_t count) {
  return (count + kMostLanes - 1) / kMostLanes * kMostLanes;
}

double gauss_xi(std::size_t g) {
  return g % 2 == 0 ? kGaussLow : kGaussHigh;
}

double gauss_eta(std::size_t g) {
  return g / 2 == 0 ? kGaussLow : kGaussHigh;
}

std::array<double, 4> shape(double xi, double eta) {
  return {(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), (1.0 - xi) * eta, xi * eta};
}

std::array<std::size_t, 4> corners(const Block& block, std::size_t column, std::size_t row) {
  const std::size_t n = block.node(column, row);
  return {n, n + 1, n + block.stride(), n + block.stride() + 1};
}

struct Jacobian {
  double R_xi = 0.0, R_eta = 0.0, Z_xi = 0.0, Z_eta = 0.0, R = 0.0;

  [[nodiscard]] double determinant() const { return R_xi * Z_eta - R_eta * Z_xi; }
};

Jacobian jacobian_at(const Mesh& mesh, const std::array<std::size_t, 4>& nodes, double xi,
                     double eta) {
  const std::array<double, 4> by_xi = {-(1.0 - eta), 1.0 - eta, -eta, eta};
  const std::array<double, 4> by_eta = {-(1.0 - xi), -xi, 1.0 - xi, xi};
  const std::array<double, 4> N = shape(xi, eta);
  Jacobian J;
  for (std::size_t a = 0; a < 4; ++a) {
    const double R = mesh.R_m[nodes[a]];
    const double Z = mesh.Z_m[nodes[a]];
    J.R_xi += by_xi[a] * R;
    J.R_eta += by_eta[a] * R;
    J.Z_xi += by_xi[a] * Z;
    J.Z_eta += by_eta[a] * Z;
    J.R += N[a] * R;
  }
  return J;
}

// Largest eigenvalue of a symmetric tridiagonal matrix, by bisection on Sturm's count.
double largest_eigenvalue(const std::vector<double>& diagonal, const std::vector<double>& off) {
  double high = 0.0;
  for (std::size_t i = 0; i < diagonal.size(); ++i) {
    const double before = i > 0 ? std::abs(off[i - 1]) : 0.0;
    const double after = i < off.size() ? std::abs(off[i]) : 0.0;
    high = std::max(high, diagonal[i] + before + after);
  }
  double low = 0.0;
  for (int step = 0; step < 60; ++step) {
    const double guess = 0.5 * (low + high);
    double pivot = 1.0;
    bool one_above = false;
    for (std::size_t i = 0; i < diagonal.size(); ++i) {
      const double coupling = i > 0 ? off[i - 1] * off[i - 1] / pivot : 0.0;
      pivot = guess - diagonal[i] - coupling;
      one_above = one_above || pivot < 0.0;
    }
    (one_above ? low : high) = guess;
  }
  return high;
}

// Four sums at a time: one alone waits for each of its additions.
double dot(const std::vector<double>& a, const std::vector<double>& b) {
  std::array<double, 4> sums{};
  std::size_t i = 0;
  for (; i + 4 <= a.size(); i += 4) {
    for (std::size_t k = 0; k < 4; ++k) {
      sums[k] += a[i + k] * b[i + k];
    }
  }
  for (; i < a.size(); ++i) {
    sums[0] += a[i] * b[i];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}  // namespace

Body::Body(Mesh mesh, std::vector<Solid> solids, const ElementKernel& kernel)
    : mesh_(std::move(mesh)), solids_(std::move(solids)), kernel_(&kernel) {
  const std::size_t nodes = mesh_.R_m.size();
  for (std::vector<double>* array :
       {&ur_, &uz_, &vr_, &vz_, &fr_, &fz_, &mass_, &by_mass_r_, &by_mass_z_, &kept_r_, &kept_z_}) {
    array->assign(nodes, 0.0);
  }
  contributions_.assign(kForceArrays * nodes, 0.0);
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
  range.geometry.assign(kGeometryArrays * pitch, 0.0);
  range.state.assign(kStatePerBranch * solid.arms.size() * pitch, 0.0);
  for (std::size_t j = 0; j < range.region.rows; ++j) {
    for (std::size_t i = 0; i < block.columns; ++i) {
      const auto nodes = corners(block, i, range.region.first_row + j);
      double* const element = range.geometry.data() + j * stride + i;
      double volume = 0.0;
      for (std::size_t g = 0; g < 4; ++g) {
        const Jacobian J = jacobian_at(mesh_, nodes, gauss_xi(g), gauss_eta(g));
        const double determinant = J.determinant();
        const double share = 0.25 * 2.0 * std::numbers::pi * J.R * std::abs(determinant);
        double* const at = element + kGeometryPerPoint * g * pitch;
        at[0] = J.Z_eta / determinant;
        at[pitch] = -J.R_eta / determinant;
        at[2 * pitch] = -J.Z_xi / determinant;
        at[3 * pitch] = J.R_xi / determinant;
        at[4 * pitch] = share;
        at[5 * pitch] = 1.0 / J.R;
        volume += share;
      }
      for (std::size_t g = 0; g < 4; ++g) {
        element[(kGeometryPerPoint * g + 4) * pitch] /= volume;
      }
      element[(kGeometryArrays - 1) * pitch] = volume;
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
  e.shear_Pa = 2.0 * solid.shear_relaxed_Pa;
  e.bulk_Pa = solid.bulk_relaxed_Pa;
  e.nonlinearity = solid.nonlinearity;
  e.cauchy = solid.law == FiniteStrain::cauchy ? 1.0 : 0.0;
  e.branches = static_cast<int>(solid.arms.size());
  range.wave_speed_squared = solid.fastest_wave_m_per_s() * solid.fastest_wave_m_per_s();
  for (std::size_t b = 0; b < solid.arms.size(); ++b) {
    const SolidArm& arm = solid.arms[b];
    e.branch[b] = {2.0 * arm.shear_Pa, arm.bulk_Pa, 1.0 / arm.time_s, 0.0, 0.0, 0.0};
  }
}

void Body::spread_mass(const Range& range, double density_kg_m3) {
  const Block& block = mesh_.blocks[range.region.block];
  for (std::size_t j = 0; j < range.region.rows; ++j) {
    for (std::size_t i = 0; i < block.columns; ++i) {
      const auto nodes = corners(block, i, range.region.first_row + j);
      const std::size_t pitch = range.elements.pitch;
      const double* const element = range.geometry.data() + j * block.stride() + i;
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
      const double now = now_s * step.rate_per_s;
      const double next = next_s * step.rate_per_s;
      step.weight_now = now > 0.0 ? 1.0 + std::expm1(-now) / now : 0.0;
      step.decay = std::exp(-next);
      step.weight_next = next > 0.0 ? -std::expm1(-next) / next - step.decay : 0.0;
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
  const std::size_t stride = block.stride();
  const std::size_t end = block.first_node + block.nodes();
  const auto add = [&](const double* of, double* into) {
    const double* const n0 = of;
    const double* const n1 = of + pitch;
    const double* const n2 = of + 2 * pitch;
    const double* const n3 = of + 3 * pitch;
    for (std::size_t n = block.first_node; n < end; ++n) {
      into[n] = -(n0[n] + n1[n - 1] + n2[n - stride] + n3[n - stride - 1]);
    }
  };
  add(contributions_.data(), fr_.data());
  add(contributions_.data() + 4 * pitch, fz_.data());
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
  const auto move = [&](const double* force, const double* by_mass, double* velocity,
                        double* displacement) {
    for (std::size_t n = 0; n < nodes; ++n) {
      velocity[n] += velocity_step_s * force[n] * by_mass[n];
      displacement[n] += step_s * velocity[n];
    }
  };
  move(fr_.data(), by_mass_r_.data(), vr_.data(), ur_.data());
  move(fz_.data(), by_mass_z_.data(), vz_.data(), uz_.data());
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
    std::fill(range.state.begin(), range.state.end(), 0.0);
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
      step.weight_now = step.decay = step.weight_next = 0.0;
    }
  }
  // Lanczos in u = M^(-1/2) q. Tied nodes share one unknown: the copy follows.
  const std::size_t nodes = ur_.size();
  std::vector<double> root_r(nodes), root_z(nodes), counted(nodes, 1.0);
  for (std::size_t n = 0; n < nodes; ++n) {
    root_r[n] = std::sqrt(by_mass_r_[n]);
    root_z[n] = std::sqrt(by_mass_z_[n]);
  }
  for (const Tie& tie : mesh_.ties) {
    counted[tie.b] = 0.0;
  }
  std::vector<double> q(2 * nodes), before(2 * nodes, 0.0), next(2 * nodes);
  unsigned seed = 12345;
  const auto random = [&seed] {
    seed = seed * 1664525U + 1013904223U;
    return static_cast<double>(seed >> 8U) / static_cast<double>(1U << 24U) - 0.5;
  };
  for (std::size_t n = 0; n < nodes; ++n) {
    q[n] = random() * counted[n] * (root_r[n] > 0.0 ? 1.0 : 0.0);
    q[nodes + n] = random() * counted[n] * (root_z[n] > 0.0 ? 1.0 : 0.0);
  }
  const double norm = std::sqrt(dot(q, q));
  for (double& value : q) {
    value /= norm;
  }
  double length_m = 0.0;
  for (const double R : mesh_.R_m) {
    length_m = std::max(length_m, R);
  }
  const double small = 1e-10 * length_m * std::sqrt(mass_kg());
  std::vector<double> diagonal, off;
  double coupling = 0.0;
  for (int k = 0; k < steps; ++k) {
    for (std::size_t n = 0; n < nodes; ++n) {
      ur_[n] = small * root_r[n] * q[n];
      uz_[n] = small * root_z[n] * q[nodes + n];
    }
    for (const Tie& tie : mesh_.ties) {
      ur_[tie.b] = ur_[tie.a];
      uz_[tie.b] = uz_[tie.a];
    }
    find_forces(false);
    for (const Spring& spring : springs) {
      push(spring.node, -spring.stiffness_N_per_m * ur_[spring.node],
           -spring.stiffness_N_per_m * uz_[spring.node]);
    }
    join_ties();
    for (std::size_t n = 0; n < nodes; ++n) {
      next[n] = -fr_[n] * root_r[n] * counted[n] / small;
      next[nodes + n] = -fz_[n] * root_z[n] * counted[n] / small;
    }
    const double along = dot(next, q);
    diagonal.push_back(along);
    for (std::size_t i = 0; i < next.size(); ++i) {
      next[i] -= along * q[i] + coupling * before[i];
    }
    coupling = std::sqrt(dot(next, next));
    if (!(coupling > 1e-12 * along) || k + 1 == steps) {
      break;
    }
    off.push_back(coupling);
    before = q;
    for (std::size_t i = 0; i < next.size(); ++i) {
      q[i] = next[i] / coupling;
    }
  }
  std::fill(ur_.begin(), ur_.end(), 0.0);
  std::fill(uz_.begin(), uz_.end(), 0.0);
  forget();
  return std::sqrt(largest_eigenvalue(diagonal, off));
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

Body::Gradient Body::gradient_at(ElementIndex element, double xi, double eta) const {
  const auto nodes = corners(mesh_.blocks[element.block], element.column, element.row);
  const Jacobian J = jacobian_at(mesh_, nodes, xi, eta);
  const double determinant = J.determinant();
  const std::array<double, 4> by_xi = {-(1.0 - eta), 1.0 - eta, -eta, eta};
  const std::array<double, 4> by_eta = {-(1.0 - xi), -xi, 1.0 - xi, xi};
  const std::array<double, 4> N = shape(xi, eta);
  Gradient F{1.0, 0.0, 0.0, 1.0, 1.0};
  for (std::size_t a = 0; a < 4; ++a) {
    const double by_R = (by_xi[a] * J.Z_eta - by_eta[a] * J.Z_xi) / determinant;
    const double by_Z = (by_eta[a] * J.R_xi - by_xi[a] * J.R_eta) / determinant;
    F.rR += ur_[nodes[a]] * by_R;
    F.rZ += ur_[nodes[a]] * by_Z;
    F.zR += uz_[nodes[a]] * by_R;
    F.zZ += uz_[nodes[a]] * by_Z;
    F.hoop += N[a] * ur_[nodes[a]] / J.R;
  }
  return F;
}

double Body::axial_log_stretch(ElementIndex element) const {
  double total = 0.0;
  for (std::size_t g = 0; g < 4; ++g) {
    const Gradient F = gradient_at(element, gauss_xi(g), gauss_eta(g));
    total += 0.25 * std::log(std::hypot(F.zZ, F.rZ));
  }
  return total;
}

void Body::find_strained_share(double strain, std::span<double> share) const {
  std::fill(share.begin(), share.end(), 0.0);
  for (const Range& range : ranges_) {
    const Block& block = mesh_.blocks[range.region.block];
    for (std::size_t row = 0; row < range.region.rows; ++row) {
      for (std::size_t column = 0; column < block.columns; ++column) {
        const Gradient F =
            gradient_at({range.region.block, column, range.region.first_row + row}, 0.5, 0.5);
        const double area = F.rR * F.zZ - F.rZ * F.zR;
        const double half = 0.5 * (F.rR * F.rR + F.zR * F.zR - F.rZ * F.rZ - F.zZ * F.zZ);
        const double slope_q = 0.5 * std::asinh(std::hypot(half, F.rR * F.rZ + F.zR * F.zZ) / area);
        const double mean = (std::log(area) - 2.0 * std::log(F.hoop)) / 6.0;
        const double equivalent = std::sqrt(4.0 * mean * mean + 4.0 / 3.0 * slope_q * slope_q);
        const double volume = range.geometry[(kGeometryArrays - 1) * range.elements.pitch +
                                             row * block.stride() + column];
        share[range.region.solid] +=
            equivalent > strain ? volume / volume_m3_[range.region.solid] : 0.0;
      }
    }
  }
}

double Body::axial_stress_Pa(ElementIndex element) const {
  const auto found = std::find_if(ranges_.begin(), ranges_.end(), [&](const Range& range) {
    return range.region.block == element.block && element.row >= range.region.first_row &&
           element.row < range.region.first_row + range.region.rows;
  });
  const ElementRange& e = found->elements;
  const std::size_t index = (element.row - found->region.first_row) * e.stride + element.column;
  struct Point {
    Gradient F;
    double area, J, weight;
  };
  std::array<Point, 4> points{};
  double volume_ratio = 0.0;
  for (std::size_t g = 0; g < 4; ++g) {
    const Gradient F = gradient_at(element, gauss_xi(g), gauss_eta(g));
    const double area = F.rR * F.zZ - F.rZ * F.zR;
    const double weight = e.geometry[(kGeometryPerPoint * g + 4) * e.pitch + index];
    points[g] = {F, area, area * F.hoop, weight};
    volume_ratio += weight * area * F.hoop;
  }
  // The kept number is ahead by the coming step: take that back to have the dashpot's strain.
  const auto stress_of = [&](double relaxed, double strain, std::size_t component, bool shear) {
    double stress = relaxed * strain;
    for (int b = 0; b < e.branches; ++b) {
      const BranchStep& step = e.branch[b];
      const double kept =
          e.state[(kStatePerBranch * static_cast<std::size_t>(b) + component) * e.pitch + index];
      const double dashpot = (kept - step.weight_next * strain) / step.decay;
      stress += (shear ? step.shear_Pa : step.bulk_Pa) * (strain - dashpot);
    }
    return stress;
  };
  const double pressure = stress_of(e.bulk_Pa, std::log(volume_ratio), 12, false) *
                          (1.0 + e.cauchy * (volume_ratio - 1.0)) / volume_ratio;
  double total = 0.0;
  for (std::size_t g = 0; g < 4; ++g) {
    const auto& [F, area, J, weight] = points[g];
    const double c11 = F.rR * F.rR + F.zR * F.zR;
    const double c22 = F.rZ * F.rZ + F.zZ * F.zZ;
    const double c12 = F.rR * F.rZ + F.zR * F.zZ;
    const double half = 0.5 * (c11 - c22);
    const double q = std::hypot(half, c12);
    const double twice = std::asinh(q / area);  // ln of the ratio of the principal stretches
    const double slope = q > 1e-12 ? 0.5 * twice / q : 0.5 / area;
    const double mean = (std::log(area) - 2.0 * std::log(F.hoop)) / 6.0;
    const double squared = 6.0 * mean * mean + 2.0 * slope * slope * q * q;
    const double factor = 1.0 + e.nonlinearity * std::sqrt(2.0 / 3.0 * squared);
    const double t_mean = stress_of(e.shear_Pa, factor * mean, 3 * g, true);
    const double t_half = stress_of(e.shear_Pa, factor * slope * half, 3 * g + 1, true);
    const double t_shear = stress_of(e.shear_Pa, factor * slope * c12, 3 * g + 2, true);
    // Kirchhoff stress F S F' with S as in the kernel.
    const double product = t_half * half + t_shear * c12;
    const double bend = q > 1e-4 * area
                            ? product * (0.5 * (c11 + c22) / (area * area) - 2.0 * slope) / (q * q)
                            : product * 2.0 / (3.0 * area * area * area);
    const double s22 = -product / (area * area) - 2.0 * slope * t_half - bend * half;
    const double s11 = -product / (area * area) + 2.0 * slope * t_half + bend * half;
    const double s12 = 2.0 * slope * t_shear + bend * c12;
    const double kirchhoff =
        t_mean + F.zR * F.zR * s11 + 2.0 * F.zR * F.zZ * s12 + F.zZ * F.zZ * s22;
    total += weight * (kirchhoff * (1.0 + e.cauchy * (J - 1.0)) / J + pressure);
  }
  return total;
}

ElementIndex Body::most_squeezed() const {
  ElementIndex worst;
  double least = 2.0;
  for (std::size_t b = 0; b < mesh_.blocks.size(); ++b) {
    for (std::size_t row = 0; row < mesh_.blocks[b].rows; ++row) {
      for (std::size_t column = 0; column < mesh_.blocks[b].columns; ++column) {
        for (std::size_t g = 0; g < 4; ++g) {
          const Gradient F = gradient_at({b, column, row}, gauss_xi(g), gauss_eta(g));
          const double area = F.rR * F.zZ - F.rZ * F.zR;
          if (!(area >= least)) {
            least = area;
            worst = {b, column, row};
          }
        }
      }
    }
  }
  return worst;
}

std::string Body::describe(ElementIndex element) const {
  const auto nodes = corners(mesh_.blocks[element.block], element.column, element.row);
  double R_mm = 0.0;
  double Z_mm = 0.0;
  for (const std::size_t node : nodes) {
    R_mm += 250.0 * mesh_.R_m[node];
    Z_mm += 250.0 * mesh_.Z_m[node];
  }
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(),
                "element %zu of row %zu in block %zu (R %.2f mm, Z %.2f mm)", element.column,
                element.row, element.block, R_mm, Z_mm);
  return text.data();
}

}  // namespace kolsky::impact

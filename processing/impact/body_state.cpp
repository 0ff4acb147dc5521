// What a body's elements hold: strains, stresses, which of them is squeezed.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "processing/impact/body.hpp"
#include "processing/impact/quadrilateral.hpp"

namespace kolsky::impact {

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

void Body::find_strained_share(std::span<const double> strain, std::span<double> share) const {
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
            equivalent > strain[range.region.solid] ? volume / volume_m3_[range.region.solid] : 0.0;
      }
    }
  }
}

const Body::Range& Body::range_of(ElementIndex element) const {
  return *std::find_if(ranges_.begin(), ranges_.end(), [&](const Range& range) {
    return range.region.block == element.block && element.row >= range.region.first_row &&
           element.row < range.region.first_row + range.region.rows;
  });
}

// Stress of a component by its strain. The kept number is ahead by the coming step: that is taken
// back to have the dashpot's strain.
double Body::law_at(const Range& range, std::size_t index, Component component,
                    double strain) const {
  const ElementRange& e = range.elements;
  const bool volume = component.number == kVolumeComponent;
  double stress = (volume ? e.bulk_Pa : e.shear_Pa) * strain;
  for (int b = 0; b < e.branches; ++b) {
    const BranchStep& step = e.branch[b];
    const std::size_t array = kStatePerBranch * static_cast<std::size_t>(b) + component.number;
    const double dashpot =
        (e.state[array * e.pitch + index] - step.weight_next * strain) / (1.0 - step.loss);
    stress += (volume ? step.bulk_Pa : step.shear_Pa) * (strain - dashpot);
  }
  return stress;
}

// Axial Kirchhoff stress of a point without its pressure: (F S F')_zz, S as in the kernel.
double Body::deviatoric_at(const Range& range, std::size_t index, std::size_t g,
                           const Gradient& F) const {
  const double area = F.rR * F.zZ - F.rZ * F.zR;
  const double c11 = F.rR * F.rR + F.zR * F.zR;
  const double c22 = F.rZ * F.rZ + F.zZ * F.zZ;
  const double c12 = F.rR * F.rZ + F.zR * F.zZ;
  const double half = 0.5 * (c11 - c22);
  const double q = std::hypot(half, c12);
  const double ratio_log = std::asinh(q / area);  // of the principal stretches in the plane
  const double slope = q > 1e-12 ? 0.5 * ratio_log / q : 0.5 / area;
  const double mean = (std::log(area) - 2.0 * std::log(F.hoop)) / 6.0;
  const double squared = 6.0 * mean * mean + 2.0 * slope * slope * q * q;
  const double factor = 1.0 + range.elements.nonlinearity * std::sqrt(2.0 / 3.0 * squared);
  const double t_mean = law_at(range, index, {3 * g}, factor * mean);
  const double t_half = law_at(range, index, {3 * g + 1}, factor * slope * half);
  const double t_shear = law_at(range, index, {3 * g + 2}, factor * slope * c12);
  const double product = t_half * half + t_shear * c12;
  const double bend = q > 1e-4 * area
                          ? product * (0.5 * (c11 + c22) / (area * area) - 2.0 * slope) / (q * q)
                          : product * 2.0 / (3.0 * area * area * area);
  const double spherical = -product / (area * area);
  const double difference = 2.0 * slope * t_half + bend * half;
  const double s12 = 2.0 * slope * t_shear + bend * c12;
  return t_mean + F.zR * F.zR * (spherical + difference) + 2.0 * F.zR * F.zZ * s12 +
         F.zZ * F.zZ * (spherical - difference);
}

double Body::axial_stress_Pa(ElementIndex element) const {
  const Range& range = range_of(element);
  const ElementRange& e = range.elements;
  const std::size_t index = (element.row - range.region.first_row) * e.stride + element.column;
  double volume_ratio = 0.0;
  double deviatoric = 0.0;
  for (std::size_t g = 0; g < 4; ++g) {
    const Gradient F = gradient_at(element, gauss_xi(g), gauss_eta(g));
    const double J = (F.rR * F.zZ - F.rZ * F.zR) * F.hoop;
    const double weight = e.geometry[(kGeometryPerPoint * g + 4) * e.pitch + index];
    volume_ratio += weight * J;
    deviatoric += weight * deviatoric_at(range, index, g, F) * (1.0 + e.cauchy * (J - 1.0)) / J;
  }
  const double mean = law_at(range, index, {kVolumeComponent}, std::log(volume_ratio));
  return deviatoric + mean * (1.0 + e.cauchy * (volume_ratio - 1.0)) / volume_ratio;
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

ElementIndex Body::soonest_crossed() const {
  ElementIndex soonest;
  double least_s2 = std::numeric_limits<double>::infinity();
  const auto between_m = [&](std::size_t a, std::size_t b) {
    return std::hypot(mesh_.R_m[a] - mesh_.R_m[b], mesh_.Z_m[a] - mesh_.Z_m[b]);
  };
  for (const Range& range : ranges_) {
    const Block& block = mesh_.blocks[range.region.block];
    const std::size_t end = range.region.first_row + range.region.rows;
    for (std::size_t row = range.region.first_row; row < end; ++row) {
      for (std::size_t column = 0; column < block.columns; ++column) {
        const auto n = corners(block, column, row);
        const double area_m2 = std::abs(jacobian_at(mesh_, n, 0.5, 0.5).determinant());
        const double across_m = area_m2 / std::max(between_m(n[0], n[3]), between_m(n[1], n[2]));
        const double square_s2 = across_m * across_m / range.wave_speed_squared;
        if (square_s2 < least_s2) {
          least_s2 = square_s2;
          soonest = {range.region.block, column, row};
        }
      }
    }
  }
  return soonest;
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

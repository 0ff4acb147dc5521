#pragma once

#include <array>
#include <cstddef>

#include "processing/impact/mesh.hpp"

namespace kolsky::impact {

/// The bilinear quadrilateral: coordinates xi, eta from 0 to 1, 2 x 2 Gauss points.
inline constexpr double kGaussLow = 0.21132486540518712;  // (1 - 1/sqrt(3))/2
inline constexpr double kGaussHigh = 0.78867513459481288;

inline double gauss_xi(std::size_t g) {
  return g % 2 == 0 ? kGaussLow : kGaussHigh;
}

inline double gauss_eta(std::size_t g) {
  return g / 2 == 0 ? kGaussLow : kGaussHigh;
}

inline std::array<double, 4> shape(double xi, double eta) {
  return {(1.0 - xi) * (1.0 - eta), xi * (1.0 - eta), (1.0 - xi) * eta, xi * eta};
}

inline std::array<std::size_t, 4> corners(const Block& block, std::size_t column, std::size_t row) {
  const std::size_t n = block.node(column, row);
  return {n, n + 1, n + block.stride(), n + block.stride() + 1};
}

struct Jacobian {
  double R_xi = 0.0, R_eta = 0.0, Z_xi = 0.0, Z_eta = 0.0, R = 0.0;

  [[nodiscard]] double determinant() const { return R_xi * Z_eta - R_eta * Z_xi; }
};

inline Jacobian jacobian_at(const Mesh& mesh, const std::array<std::size_t, 4>& nodes, double xi,
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

}  // namespace kolsky::impact

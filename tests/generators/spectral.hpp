#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace kolsky::testing {

/// Nodes in [-1, 1], quadrature weights and the matrix that differentiates what is given at the
/// nodes.
struct SpectralRule {
  std::vector<double> node, weight;
  std::vector<std::vector<double>> derivative;  ///< [at][of]
};

/// Gauss-Lobatto-Legendre: both ends are nodes.
[[nodiscard]] SpectralRule lobatto(int points);
/// Gauss-Radau-Legendre: +1 is a node.
[[nodiscard]] SpectralRule radau(int points);

/// Derivatives of the nodes' Lagrange polynomials at x.
[[nodiscard]] std::vector<double> lagrange_slopes(const SpectralRule& rule, double x);

/// Five-stage fourth-order Runge-Kutta with one extra register (Carpenter and Kennedy, 1994).
struct LowStorageRungeKutta {
  static constexpr std::array<double, 5> kA{
      0.0, -567301805773.0 / 1357537059087.0, -2404267990393.0 / 2016746695238.0,
      -3550918686646.0 / 2091501179385.0, -1275806237668.0 / 842570457699.0};
  static constexpr std::array<double, 5> kB{
      1432997174477.0 / 9575080441755.0, 5161836677717.0 / 13612068292357.0,
      1720146321549.0 / 2090206949498.0, 3134564353537.0 / 4481467310338.0,
      2277821191437.0 / 14882151754819.0};
  static constexpr std::array<double, 5> kC{
      0.0, 1432997174477.0 / 9575080441755.0, 2526269341429.0 / 6820363962896.0,
      2006345519317.0 / 3224310063776.0, 2802321613138.0 / 2924317926251.0};
  static constexpr double kImaginaryReach = 3.3;  ///< stable for w dt up to this
};

}  // namespace kolsky::testing

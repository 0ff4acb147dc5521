#pragma once

#include <span>
#include <vector>

#include "processing/models/scene.hpp"

namespace kolsky {

/// Exact first-mode waves (see PochhammerChree) for any linear solid of constant Poisson's ratio.
/// With z = (gamma_elementary a)^2 the frequency equation holds no other number: (gamma/gamma_el)^2
/// and the surface-to-mean ratio are analytic functions of z alone (its inverse has a pole where
/// surface gauges go blind). They are kept as Taylor
/// polynomials around places on the imaginary axis of sqrt(z), where slightly damped bars live, so
/// that a change of the bar's moduli costs a polynomial instead of a root.
class ExactWaves {
 public:
  explicit ExactWaves(double poisson_ratio);

  struct Ratios {
    Complex gamma_squared;  ///< (gamma / gamma_elementary)^2
    Complex surface_over_mean;
  };
  /// @param z  (gamma_elementary radius)^2; beyond the table's end (|z| = 9) its last place's value
  [[nodiscard]] Ratios at(Complex z) const;

 private:
  static constexpr std::size_t kOrder = 12;
  struct Place {
    Complex centre;  ///< of sqrt(z)
    Complex gamma_squared[kOrder];
    Complex mean[kOrder];
  };
  std::vector<Place> places_;
};

/// gamma += strength (gamma_exact - gamma); the surface-to-mean ratio likewise.
void blend_exact_waves(BarScene& bar, std::span<const Complex> s, double strength);

}  // namespace kolsky

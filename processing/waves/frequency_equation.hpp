#pragma once

#include "processing/waves/compliance.hpp"

namespace kolsky {

/// The frequency equation of Pochhammer and Chree as a relation F(z, r) = 0 between
/// z = (gamma0 a)^2, gamma0 elementary, and r = (gamma / gamma0)^2, for one Poisson's ratio n. With
/// c_p = (1 + n)(1 - 2n) / (1 - n), c_q = 2 (1 + n), P = (pa)^2 = z (r - c_p),
/// Q = (qa)^2 = z (r - c_q), and K(X) = 2 J1(sqrt X) / sqrt X, J(X) = J0(sqrt X), the printed
/// equation over z^2 is
///   F = -c_q (r - c_p) K(P) K(Q) - (2 r - c_q)^2 J(P) K(Q) + 4 r (r - c_p) K(P) J(Q).
/// It is entire in z and r; r(0) = 1.
class FrequencyEquation {
 public:
  explicit FrequencyEquation(double poisson_ratio);

  struct Root {
    Complex ratio;
    Complex slope;  ///< d ratio / d z
  };
  /// Newton's method from a guess near the root.
  [[nodiscard]] Root solve(Complex z, Complex guess) const;

  /// Axial strain of the mode, mean over the section by that at the surface.
  [[nodiscard]] Complex mean_over_surface(Complex z, Complex ratio) const;

 private:
  struct Value {
    Complex F, by_ratio, by_z;
  };
  [[nodiscard]] Value evaluate(Complex z, Complex ratio) const;

  double cp_;
  double cq_;
};

}  // namespace kolsky

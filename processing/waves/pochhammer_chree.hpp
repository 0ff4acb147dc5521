#pragma once

#include <vector>

#include "processing/waves/compliance.hpp"

namespace kolsky {

/// The first axisymmetric mode of a round bar at one s.
struct BarMode {
  Complex gamma;              ///< propagation coefficient [1/m]; a wave in +x goes as exp(-gamma x)
  Complex mean_over_surface;  ///< axial strain, mean over the section by that at the surface
  /// d log gamma / d log J at this s, so also by the density; 2 slope - 1 is that by the radius.
  Complex slope = 0.5;
};

/// Exact longitudinal waves in a round bar (Pochhammer, Chree), first mode, for a linear solid of
/// compliance J(s) and constant Poisson's ratio. With xi = gamma / i, w = s / i, complex Lame
/// moduli,
///   p^2 = rho w^2 / (lambda + 2 mu) - xi^2,   q^2 = rho w^2 / mu - xi^2,
///   (2p/a)(q^2 + xi^2) J1(pa) J1(qa) - (q^2 - xi^2)^2 J0(pa) J1(qa) - 4 xi^2 p q J1(pa) J0(qa) =
///   0.
/// Divided by q it depends on p^2, q^2 and xi^2 alone and is entire in them: no branches. It ties
/// (gamma / gamma0)^2 to (gamma0 a)^2 (gamma0 elementary) by Poisson's ratio alone, whatever the
/// material, which gives the slope as an implicit derivative.
/// Mean stress over the section is rho s^2 / gamma^2 times mean strain.
class PochhammerChree {
 public:
  /// @param compliance outlives this
  PochhammerChree(double density_kg_m3, double poisson_ratio, double radius_m,
                  const Compliance& compliance);

  /// The mode along a path of s that moves in steps small enough that each root is near what the
  /// ones before it foretell. Beyond |gamma0 a| = 12, where surface waves have long taken over, the
  /// last ratio to gamma0 is kept.
  ///
  /// The first mode meets another where the real part of gamma0 a is about Poisson's ratio (and the
  /// imaginary part 1.8): to the right of that it is not the same mode any more, and sends waves
  /// ahead of themselves. A path that starts there is of a record that is too short for its bar.
  ///
  /// Without a Poisson's ratio the elementary wave is that mode, nothing goes sideways, and it
  /// meets the other without coupling. The equation says so of gamma, and nothing (0 / 0) of the
  /// surface's strain.
  /// @throws InputError with how much longer a record has to be
  [[nodiscard]] std::vector<BarMode> along(const std::vector<Complex>& path) const;

 private:
  void require_little_damping(double through_radius) const;

  double density_kg_m3_;
  double poisson_ratio_;
  double radius_m_;
  const Compliance* compliance_;
};

}  // namespace kolsky

#pragma once

#include "tests/generators/bar_response.hpp"

namespace kolsky::testing {

/// A round bar as a solid: axisymmetric spectral elements in the time domain, so that lateral
/// inertia and everything else that disperses a real bar's waves is there. The radial displacement
/// is r p(r^2, z), the axial one q(r^2, z), polynomials in r^2 through Gauss-Radau points (the
/// surface is one) and in z through Gauss-Lobatto points; Poisson's ratio is the same at every
/// frequency, so that the Kelvin chain acts on each strain alike. Struck by a uniform pressure.
struct SolidBarProblem {
  KelvinChain material;
  double density_kg_m3 = 1180.0;
  double poisson_ratio = 0.36;
  double radius_m = 0.010;
  std::vector<double> stations_m;
  std::optional<double> free_end_m;  ///< none: the bar goes on for ever
  double window_s = 2e-3;
};

struct SolidBarNumerics {
  double element_radii = 1.6;  ///< length of an element over the radius
  double output_step_s = 0.5e-6;
  double step_share = 0.9;  ///< of the longest stable step
};

/// Axial strain of the surface at each station per pascal of source (compression positive).
[[nodiscard]] Responses solid_bar_response(const SolidBarProblem& problem, const UnitSource& source,
                                           const SolidBarNumerics& numerics = {});

}  // namespace kolsky::testing

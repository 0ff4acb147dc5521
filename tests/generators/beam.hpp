#pragma once

#include "tests/generators/bar_response.hpp"

namespace kolsky::testing {

/// A round viscoelastic Timoshenko beam (spectral elements in the time domain, shear coefficient
/// 6(1+nu)/(7+6nu)), struck so that the axial stress at its end also makes a moment.
struct BeamProblem {
  KelvinChain material;
  double density_kg_m3 = 1180.0;
  double poisson_ratio = 0.36;
  double radius_m = 0.010;
  std::vector<double> stations_m;
  double window_s = 2e-3;
  /// What a gauge is taken to read: the curvature of the deflection instead of the section's turn.
  bool of_deflection = false;
};

/// Bending strain of the surface, radius times the turn of the section per length (or times w''),
/// at each station: per pascal of axial stress at the end and metre of eccentricity. The beam goes
/// on for ever.
[[nodiscard]] Responses beam_response(const BeamProblem& problem, const UnitSource& source,
                                      double output_step_s = 0.5e-6);

}  // namespace kolsky::testing

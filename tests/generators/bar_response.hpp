#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "tests/generators/kelvin_chain.hpp"
#include "tests/generators/unit_source.hpp"

namespace kolsky::testing {

/// What a bar returns from its far end: the stress reflection R = -1 + r, the same at every
/// frequency. That is exactly what a further bar of the same material does whose area is
/// r/(2 - r) times as large; r = 0 is a free end, 1 no end at all, 2 a rigid wall.
struct FarEndReturn {
  double bar_length_m = 0.0;
  double r = 0.0;
};

/// A thin bar struck at x = 0 by one unit source of stress; the end is free otherwise.
struct BarProblem {
  KelvinChain material;
  double density_kg_m3 = 1180.0;
  std::vector<double> stations_m;
  std::optional<FarEndReturn> far_end;          ///< none: the bar goes on for ever
  std::function<double(double)> relative_area;  ///< over x; none where the bar is uniform
  double window_s = 2e-3;
};

/// Numerical settings. Two runs, one with half the step, are combined to fourth order.
struct BarNumerics {
  double step_s = 1e-6;
  double output_step_s = 0.5e-6;
  bool extrapolate = true;
};

/// Strain at each station per pascal of source. Stops early where all has died away.
[[nodiscard]] Responses bar_response(const BarProblem& problem, const UnitSource& source,
                                     const BarNumerics& numerics = {});

}  // namespace kolsky::testing

#pragma once

#include <functional>

#include "processing/impact/impact_history.hpp"
#include "processing/impact/impact_model.hpp"

namespace kolsky::impact {

/// Where a run has got to.
struct Progress {
  double time_s = 0.0;
  double force_N = 0.0;
  std::size_t steps = 0;
};

/// Runs an impact: axisymmetric, explicit, finite deformation (docs/impact.md). Pure: no globals,
/// any number of calls at once.
/// @param progress  called every few steps, if given
/// @throws InputError: a model that check() refuses; a time step past stability; an element that
/// turns
///   inside out; a ball that does not leave. Its line names the element and the time
[[nodiscard]] ImpactHistory simulate(const ImpactModel& model,
                                     const std::function<void(const Progress&)>& progress = {});

}  // namespace kolsky::impact

#pragma once

#include <functional>
#include <string>

#include "processing/impact/element_kernel.hpp"
#include "processing/impact/impact_history.hpp"
#include "processing/impact/impact_model.hpp"

namespace kolsky::impact {

/// Where a run has got to.
struct Progress {
  double time_s = 0.0;
  double force_N = 0.0;
  std::size_t steps = 0;
};

/// Share of a layer's volume from which on strained_words() are to be said.
inline constexpr double kStrainedShareToTell = 0.05;

/// What a share of a layer's volume beyond a strain of 0.1 means for a comparison, in a sentence.
/// @param layer  "the core"
[[nodiscard]] std::string strained_words(double share, const std::string& layer);

/// Runs an impact: axisymmetric, explicit, finite deformation (docs/impact.md). Pure: no globals,
/// any number of calls at once.
/// @param progress  called every few steps, if given
/// @param kernel    of the elements; another than the fastest is for comparison
/// @throws InputError: a model that check() refuses; a time step past stability; an element that
/// turns
///   inside out; a ball that does not leave. Its line names the element and the time
[[nodiscard]] ImpactHistory simulate(const ImpactModel& model,
                                     const std::function<void(const Progress&)>& progress = {},
                                     const ElementKernel& kernel = element_kernel());

}  // namespace kolsky::impact

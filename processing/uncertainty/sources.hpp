#pragma once

#include <functional>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/identification/bar_prior.hpp"

namespace kolsky {

/// Something that is filed with a standard deviation.
struct UncertaintySource {
  std::string name;   ///< as in a bench file, "gauges.g1.position_m"
  std::string group;  ///< sources of one group share a line of the budget
  double value = 0.0;
  double sd = 0.0;  ///< in the unit of the value
  /// Moves it by so many standard deviations.
  std::function<void(Bench&, Material&, double)> move;
};

/// Everything of a specimen bench and its bars that is filed with a deviation.
/// @param softening_per_K  relative loss of the bars' moduli
[[nodiscard]] std::vector<UncertaintySource> uncertainty_sources(const Bench& bench,
                                                                 const BarPrior& bars,
                                                                 double softening_per_K);

}  // namespace kolsky

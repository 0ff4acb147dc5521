#pragma once

#include <functional>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/identification/bar_prior.hpp"

namespace kolsky {

/// What a shot is reduced with, as far as it is not known.
struct ShotNumbers {
  Bench bench;
  Material bars;
  double push_goes_on = 0.0;  ///< as in ReductionOptions
  double band_limit_Hz = 0.0;
};

/// Something that is filed with a standard deviation.
struct UncertaintySource {
  std::string name;   ///< as in a bench file, "gauges.g1.position_m"
  std::string group;  ///< sources of one group share a line of the budget
  double value = 0.0;
  double sd = 0.0;  ///< in the unit of the value
  /// Moves it by so many standard deviations.
  std::function<void(ShotNumbers&, double)> move;
};

/// Everything of a bench and its bars that is filed with a deviation. Of a bench of kind "bar" not
/// a viscoelastic bar's moduli, nor what softens them: they are what its shots are to tell.
[[nodiscard]] std::vector<UncertaintySource> uncertainty_sources(const Bench& bench,
                                                                 const BarPrior& bars);

inline constexpr const char* kHiddenPush = "push_left_share";

/// What is left of the striker's push where the reflection hides it may go on behind: one deviation
/// is all of it.
/// @param left_share  of the push's peak
[[nodiscard]] UncertaintySource hidden_push_source(double left_share);

/// What is above the band is missing from every history. Where the band ends below what the noise
/// allows, because the bars are known no further or because it was asked for, one deviation is all
/// that lies between, to one side: nothing else is missing less.
/// @param widest_Hz  where the noise would let it end
[[nodiscard]] UncertaintySource band_limit_source(double limit_Hz, double widest_Hz);

}  // namespace kolsky

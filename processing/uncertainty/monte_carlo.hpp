#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/budget.hpp"
#include "processing/base/workers.hpp"
#include "processing/reduction/reducer.hpp"
#include "processing/uncertainty/scatter.hpp"
#include "processing/uncertainty/sources.hpp"

namespace kolsky {

struct UncertaintyOptions {
  std::size_t draws = 1000;
  std::uint64_t seed = 1;
  /// What is not known of the reduction's bar model; none: its own deviations, as independent.
  std::optional<BarPrior> bars;
};

/// A history's standard deviation and 95 % interval, at each of its times.
struct Band {
  std::vector<double> sd;
  std::vector<double> low;
  std::vector<double> high;
};

struct Uncertainty {
  std::size_t draws = 0;   ///< that gave a result
  std::size_t failed = 0;  ///< that could not be reduced
  Band stress_Pa;
  Band strain;
  Band strain_rate_per_s;
  Band force_front_N;
  Band force_back_N;
  std::vector<UncertainFigure> figures;  ///< read off the curve
  std::vector<BudgetLine> budget;        ///< the largest contribution to the first figure first
  std::vector<UncertaintySource> sources;
  /// Names of sources that the budget lacks: moved by one deviation the shot cannot be reduced.
  std::vector<std::string> uncounted;
};

/// Propagates what is filed with a deviation, and the gauges' noise as it is before the pulse,
/// through the reduction itself (GUM supplement 1): each draw moves every source by a normal
/// number, adds noise of the measured spectrum to the samples and is reduced like the shot, its own
/// arrival found anew. The band limit, the histories' length and how waves are separated are the
/// shot's. The budget moves
/// one source at a time by one deviation to either side. The same seed gives the same numbers,
/// however the workers share it.
/// @param reduction  of this shot with these options; where it is not reducible nothing is drawn
[[nodiscard]] Uncertainty propagate(const Shot& shot, const ReductionOptions& options,
                                    const Reduction& reduction,
                                    const UncertaintyOptions& uncertainty, const Workers& workers);

}  // namespace kolsky

#pragma once

#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// The numbers of a loop that go into one line.
struct LoopSummary {
  double peak_stress_Pa = 0.0;
  double strain_at_peak = 0.0;  ///< at the peak stress
  double peak_strain = 0.0;
  double loading_s = 0.0;  ///< from 5 % of the peak stress to 98 % of the largest strain
  double mean_strain_rate_per_s = 0.0;  ///< over the loading
};

/// Samples up to the largest strain, in the sense of the largest stress: what follows, the specimen
/// unloads, or the histories drift.
[[nodiscard]] std::size_t loading_end(const Reduction& reduction);

/// All zero for an empty reduction.
[[nodiscard]] LoopSummary summarise(const Reduction& reduction);

}  // namespace kolsky

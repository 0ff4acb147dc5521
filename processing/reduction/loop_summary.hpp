#pragma once

#include <string>

#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// The numbers of a loop's first loading that go into one line. Largest in the sense of the
/// loading: of a specimen that is pulled, stress and strain are negative.
struct LoopSummary {
  double peak_stress_Pa = 0.0;
  double strain_at_peak = 0.0;  ///< at the peak stress
  double peak_strain = 0.0;
  /// From 5 % of its peak stress to 98 % of its largest strain.
  double loading_s = 0.0;
  double mean_strain_rate_per_s = 0.0;  ///< over the loading
  /// Why there is no loading to give numbers of: those above are not to be shown then. Empty where
  /// there is one.
  std::string no_loading;
};

/// Whether the specimen is pulled at first, whatever later passes of the wave do.
[[nodiscard]] bool is_pulled(const Reduction& reduction);

/// Samples up to the largest strain of the first loading, in its sense: what follows, the specimen
/// unloads, is loaded again, or the histories drift. The first loading is over when the strain has
/// come back by a tenth of its largest so far, or a tenth of the largest stress so far is left and
/// the strain grows no more.
[[nodiscard]] std::size_t loading_end(const Reduction& reduction);

/// All numbers zero for an empty reduction.
[[nodiscard]] LoopSummary summarise(const Reduction& reduction);

}  // namespace kolsky

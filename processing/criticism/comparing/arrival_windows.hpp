#pragma once

#include <string>
#include <vector>

#include "processing/criticism/fitting/composition.hpp"
#include "processing/criticism/fitting/residuals.hpp"

namespace kolsky {

inline constexpr const char* kBeforePulse = "before the pulse";

/// A stretch of a gauge's judged record, named after the wave that arrives in it. Neighbours fade
/// into one another: the squares of all weights of a gauge add up to one at every sample, so that
/// energies of the stretches add up to that of the record.
struct ArrivalWindow {
  std::string name;      ///< "before the pulse", "incident pulse", ...
  double start_s = 0.0;  ///< from the pulse's foot at the reference gauge
  double end_s = 0.0;
  std::vector<double> weight;  ///< one per judged sample
};

/// The windows of every gauge of one shot.
///   bar: before the pulse, incident pulse, after the pulse;
///   split bar, input: before the pulse, incident pulse, reflected pulse, later; output: before the
///   pulse, transmitted pulse, later.
/// Waves arrive when their front (modulus at infinite frequency) does; a pulse is over when the
/// reference gauge has fallen to a tenth of its peak. A window with no sample in it is left out.
/// @param theta  of the composition, in scales
/// @return by gauge
[[nodiscard]] std::vector<std::vector<ArrivalWindow>> arrival_windows(
    WhiteResiduals& residuals, const Composition& composition, const std::vector<double>& theta,
    std::size_t shot);

}  // namespace kolsky

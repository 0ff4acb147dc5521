#pragma once

#include <string>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/impact/impact_residuals.hpp"

namespace kolsky {

/// Whether what an effect adds to the records (hum, drift) stands in them before the pulse, too, as
/// what has nothing to do with the impact must. A zero that moves as the pulse arrives does not.
///
/// With r the low-passed records of all shots and gauges in the quiet before their pulses and a
/// what is fitted to be added there, at samples as far apart as the judged ones, each stretch's
/// mean free and S its noise,
///     q = a^T S^-1 r / a^T S^-1 a
/// has to be 1 +- 0.5 and four of its deviations off nothing; those by S or by what r - q a
/// scatters, whichever is more. As far as the pulses leave strengths open, a has them by the quiet,
/// too, and stands out by one square more for each that the quiet had to tell. Too little quiet
/// confirms nothing.
/// True for effects that add nothing to records.
[[nodiscard]] bool stands_before_pulse(const Studied& studied, const std::string& id,
                                       const ImpactResiduals& residuals);

}  // namespace kolsky

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
/// scatters, whichever is more. Where that fails and the pulses leave strengths so open that the
/// quiet does not contradict them, a has them by both, and stands out by as much more as the quiet
/// had to tell. What else is added is taken off. Too little quiet confirms nothing.
/// True for effects that add nothing to records.
[[nodiscard]] bool stands_before_pulse(const Studied& studied, const std::string& id,
                                       const ImpactResiduals& residuals);

}  // namespace kolsky

#pragma once

#include <vector>

#include "processing/base/budget.hpp"
#include "processing/identification/bar_fit.hpp"

namespace kolsky {

/// Where the deviations of fitted parameters come from. A fit by least squares with the bench's
/// numbers as known to their deviations goes with each of these by the covariance of the two; the
/// rest of a variance is noise's, with what chi2 above 1 or a choice between theories adds.
/// @param by_bench  by parameter and number of the bench: covariance of the parameter with the
///   number, that in filed deviations
/// @param bench     those numbers, named as the effects that would name them
/// @return the largest contribution to the first parameter first
[[nodiscard]] std::vector<BudgetLine> parameter_budget(
    const std::vector<FittedNumber>& parameters, const std::vector<std::vector<double>>& by_bench,
    const std::vector<FittedNumber>& bench);

}  // namespace kolsky

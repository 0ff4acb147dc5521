#pragma once

#include <vector>

#include "processing/criticism/fitting/fit.hpp"
#include "processing/criticism/impact/impact_residuals.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// How large the calculation's error may be by the records themselves, over what is allowed for it
/// now: the square root of the factor on its covariance, the largest that they do not contradict
/// (95 %). By the likelihood of the groups' means, what the model's numbers take up counted out. Of
/// the model as it is and with any one candidate's strength beside it, the likeliest counts: what
/// is missing is not the calculation's. With any two where these stand before every one by what
/// tells effects apart.
[[nodiscard]] double largest_solver_share(const ImpactWhitening& whitening, const ModelFit& base,
                                          const std::vector<Candidate>& candidates,
                                          const std::vector<Direction>& directions);

}  // namespace kolsky

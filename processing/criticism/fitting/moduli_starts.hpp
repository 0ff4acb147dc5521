#pragma once

#include "processing/base/workers.hpp"
#include "processing/criticism/fitting/residuals.hpp"
#include "processing/criticism/records/campaign.hpp"
#include "processing/models/model.hpp"

namespace kolsky {

/// Moves a model's moduli near enough to the campaign's for fit_model to converge: the bar's from
/// the pulse's arrivals, a specimen's from a search over decades.
void start_moduli(Model& model, const Campaign& campaign, WhiteResiduals& residuals,
                  std::size_t worker = 0);

/// Where nobody has fitted a specimen yet, moves its moduli to where a fit ends that begins with a
/// branch which does little, if that is better than from where they are. Freezes the noise.
void start_branch(Model& model, const Campaign& campaign, WhiteResiduals& residuals,
                  const Workers& executor);

}  // namespace kolsky

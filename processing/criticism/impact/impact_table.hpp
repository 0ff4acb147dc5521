#pragma once

#include <string>
#include <vector>

#include "processing/criticism/impact/impact_certifier.hpp"
#include "processing/criticism/search/candidate_table.hpp"

namespace kolsky {

/// Every effect as a search has it, refitted or at first order.
[[nodiscard]] std::vector<CandidateResult> table_of_impacts(const ImpactSearch& search,
                                                            const ImpactCertifier& certifier);

/// What a search found of these effects, in the place of what their rows said before.
void note_refits(const ImpactSearch& search, const std::vector<std::string>& ids,
                 const ImpactCertifier& certifier, std::vector<CandidateResult>& table);

}  // namespace kolsky

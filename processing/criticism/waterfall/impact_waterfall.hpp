#pragma once

#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/waterfall/waterfall.hpp"

namespace kolsky {

/// Fits every model of a lineage to one campaign of impacts, each around fine forces of its own,
/// all under the noise that the last one shows. What is held out is one speed at a time, or one
/// shot at a time where there is one speed only.
/// @throws InputError what the solver refuses
[[nodiscard]] Waterfall waterfall(ImpactStudy& study, const std::vector<LineageStep>& lineage);

}  // namespace kolsky

#pragma once

#include <optional>
#include <string>

#include "processing/criticism/impact/impact_study.hpp"

namespace kolsky {

/// At which speed what gauges read is not the ball's change of momentum as it is at the others,
/// where speeds differ in that by more than shots of one do. Whatever a ball is made of, its
/// impulse is m (Vi + Vr): an error of the calculation has no part in this, and what is off at all
/// speeds alike (a gauge factor, the mass) is left to the claims.
[[nodiscard]] std::optional<std::string> impulse_doubt(ImpactStudy& study, const Studied& current);

}  // namespace kolsky

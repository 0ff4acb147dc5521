#pragma once

#include <string>

#include "processing/criticism/fitting/study.hpp"
#include "processing/criticism/search/quiet_slopes.hpp"

namespace kolsky {

/// What a hum in shares of each gauge's own slopes by before the pulses. A free source takes up
/// what gauges have alike of it, so that the records know its shares but for a part which the quiet
/// samples tell: these are the slopes of the products nearest to both.
/// @param id        a hum of every shot's and gauge's own, fitted
/// @param of_others slopes of whatever else is added to the records
[[nodiscard]] SlopesByShot slopes_of_products(const Studied& studied, const std::string& id,
                                              const Campaign& campaign,
                                              const SlopesByShot& of_others);

}  // namespace kolsky

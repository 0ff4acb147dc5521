#pragma once

#include <cstddef>
#include <vector>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// Noise of a gauge before the pulses, a stretch for each shot: its samples there less what all
/// shots have alike, which is no noise (a hum or a drift that every shot triggers at the same
/// phase of). Scaled to the variance that they have about what they would be alike in without end.
/// Of fewer than four shots the samples as they are: so few hardly tell what they have alike from
/// slow noise.
[[nodiscard]] std::vector<std::vector<double>> quiet_scatter(const Campaign& campaign,
                                                             std::size_t gauge);

}  // namespace kolsky

#pragma once

#include <cstddef>
#include <vector>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// By how many samples the pulses rise before where their foot is seen: one that begins more softly
/// than by the third power of time lies within what was taken for quiet, far below the noise of one
/// shot, and passes there for a drift or a hum that all shots have. Seen in the mean of all shots
/// over their heights, as what leaves the line through the quiet before.
/// @param gauge  the one that the pulses come to first
/// @return at most ten samples or 100 us and a third of the shortest quiet, so that kFewestQuiet
/// stay
[[nodiscard]] std::size_t soft_foot_samples(const std::vector<CampaignShot>& shots,
                                            std::size_t gauge, double period_s);

}  // namespace kolsky

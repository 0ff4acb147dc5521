#pragma once

#include <optional>
#include <string>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// What the order in which pulses come to the gauges says against the bench, in one line: cables,
/// columns or places that were exchanged look like no effect of a library. Times are those at which
/// one height is passed at all gauges compared, so that a wave that comes back soon, and lowers the
/// top of one gauge's pulse, changes no order. Gauges compared are neighbours on the pulse's way.
/// @return nothing where the order is the filed one in some shot
[[nodiscard]] std::optional<std::string> out_of_order(const Campaign& campaign);

}  // namespace kolsky

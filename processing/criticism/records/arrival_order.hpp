#pragma once

#include <optional>
#include <string>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// What the order in which pulses come to the gauges says against the bench, in one line: cables,
/// columns or places that were exchanged look like no effect of a library. Gauges compared are
/// neighbours on the pulse's way.
/// @return nothing where the order is the filed one in some shot
[[nodiscard]] std::optional<std::string> out_of_order(const Campaign& campaign);

}  // namespace kolsky

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// What the order in which pulses come to the gauges says against the bench, in one line: cables,
/// columns or places that were exchanged look like no effect of a library. Gauges compared are
/// neighbours on the pulse's way.
/// @return nothing where the order is the filed one in some shot
[[nodiscard]] std::optional<std::string> out_of_order(const Campaign& campaign);

/// What the first pulses say against the signs of the gauges, in one line: a gauge that reads with
/// the other sign looks like no effect of a library either.
/// @return nothing where every gauge reads as the bars are loaded in some shot, or most never do
[[nodiscard]] std::optional<std::string> of_other_sign(const Campaign& campaign);

/// Both.
[[nodiscard]] std::vector<std::string> misfiled_gauges(const Campaign& campaign);

}  // namespace kolsky

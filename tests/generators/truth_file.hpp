#pragma once

#include <nlohmann/json.hpp>

#include "tests/generators/campaign_draw.hpp"

namespace kolsky::testing {

/// Everything that was drawn or planted, for whoever scores; never beside the campaign.
[[nodiscard]] nlohmann::json truth_of(const Campaign& campaign);

}  // namespace kolsky::testing

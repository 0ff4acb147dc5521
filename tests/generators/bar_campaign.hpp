#pragma once

#include "processing/base/shot.hpp"
#include "tests/generators/bar_draw.hpp"
#include "tests/generators/bar_readings.hpp"

namespace kolsky::testing {

/// Plants an effect and notes it for the truth.
void hide(BarCampaign& campaign, const HiddenEffect& effect);

/// The campaign's records, noise and quantisation in them.
[[nodiscard]] std::vector<Shot> shots_of(const BarCampaign& campaign);
/// The same from readings that are there already.
[[nodiscard]] std::vector<Shot> shots_of(const BarCampaign& campaign, const Readings& readings);

[[nodiscard]] NoiseColour colour_named(const std::string& name);

}  // namespace kolsky::testing

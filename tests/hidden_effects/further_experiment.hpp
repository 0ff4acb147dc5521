#pragma once

#include <optional>
#include <string>

#include "tests/generators/campaign.hpp"

namespace kolsky::scoring {

/// The same bench and hidden effects with the experiment changed as a diagnosis proposes.
/// @return nothing where the generator cannot make it
[[nodiscard]] std::optional<testing::Campaign> changed_as_proposed(
    const testing::Campaign& campaign, const std::string& proposal);

}  // namespace kolsky::scoring

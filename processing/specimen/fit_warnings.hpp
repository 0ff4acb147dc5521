#pragma once

#include <string>
#include <vector>

#include "processing/specimen/specimen_fit.hpp"

namespace kolsky {

/// What keeps numbers of a solid from being taken at their word: those that the shots hardly
/// determine.
[[nodiscard]] std::vector<std::string> warnings_of(const std::vector<FittedNumber>& parameters);

/// A loss that is clearly negative, where it first is: no passive material does that.
[[nodiscard]] std::vector<std::string> warnings_of(const std::vector<CompliancePoint>& spectrum);

}  // namespace kolsky

#pragma once

#include <string>
#include <vector>

#include "processing/identification/bar_identification.hpp"

namespace kolsky {

/// What keeps an identification from being taken at its word, in sentences; gauges that were
/// exchanged first of all.
[[nodiscard]] std::vector<std::string> warnings_of(const BarIdentification& result,
                                                   const std::vector<Shot>& shots,
                                                   const BarData& data);

}  // namespace kolsky

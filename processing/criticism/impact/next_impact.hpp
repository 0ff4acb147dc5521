#pragma once

#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// An experiment that would tell apart what impacts leave tied.
[[nodiscard]] NextExperiment next_impact(const std::vector<std::string>& tied);

}  // namespace kolsky

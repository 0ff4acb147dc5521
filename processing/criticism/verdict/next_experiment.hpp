#pragma once

#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// The change of the bench that best separates an effect from those it is tied with.
[[nodiscard]] NextExperiment next_experiment(const std::string& effect,
                                             const std::vector<std::string>& ties,
                                             const Bench& bench);

}  // namespace kolsky

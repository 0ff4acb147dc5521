#pragma once

#include <string>
#include <vector>

#include "processing/models/model.hpp"

namespace kolsky {

/// The model with a drift at a gauge, alike in all shots; as it is where it has one there.
[[nodiscard]] Model with_drift(const Model& model, const std::string& gauge);

/// The model with a drift at every gauge, alike in all shots.
[[nodiscard]] Model with_drifts(const Model& model, const Bench& bench);

/// Of a fitted model, the drifts that are more than three of their deviations: "baseline-drift:g2".
[[nodiscard]] std::vector<std::string> drifting_gauges(const Model& fitted);

}  // namespace kolsky

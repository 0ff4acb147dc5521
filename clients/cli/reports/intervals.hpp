#pragma once

#include <vector>

#include "clients/cli/reports/json_value.hpp"
#include "processing/uncertainty/scatter.hpp"

namespace kolsky::cli {

/// Numbers by name, each with its deviation and 95 % interval.
[[nodiscard]] JsonObject intervals_json(const std::vector<UncertainFigure>& figures);

}  // namespace kolsky::cli

#pragma once

#include <algorithm>
#include <cmath>
#include <span>

namespace kolsky {

[[nodiscard]] inline bool all_finite(std::span<const double> history) {
  return std::ranges::all_of(history, [](double value) { return std::isfinite(value); });
}

/// What would be right where a bench makes no numbers of its records.
inline constexpr const char* kCheckPlacesAndBars =
    "check the gauges' positions and what turns readings into strain in the bench, and the bars' "
    "numbers; or take other waves (--dispersion)";

}  // namespace kolsky

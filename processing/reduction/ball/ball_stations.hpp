#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/reduction/stations.hpp"

namespace kolsky {

/// The gauges at each place of the struck bar, nearest to the struck end first.
[[nodiscard]] std::vector<BarStation> stations_by_position(const Bench& bench);

/// "g1+g2"
[[nodiscard]] std::string names_of(const BarStation& station, const Bench& bench);

/// Relative deviation of a gauge's strain, from what converts it. @param strain  its largest
[[nodiscard]] double gain_sd(const Gauge& gauge, double strain);

}  // namespace kolsky

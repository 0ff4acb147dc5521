#pragma once

#include <string>
#include <vector>

#include "processing/identification/bar_fit.hpp"

namespace kolsky {

/// What gauge 0 of a shot foretells for the others, by a fit (paper, Fig. 21).
struct ForetoldGauge {
  std::string name;
  std::vector<double> measured, foretold;  ///< strain, low-passed alike
};
struct ForetoldShot {
  std::string id;
  std::vector<double> time_s;  ///< from the first sample
  std::vector<ForetoldGauge> gauges;
};
[[nodiscard]] std::vector<ForetoldShot> foretell(const std::vector<Shot>& shots, const BarFit& fit);

}  // namespace kolsky

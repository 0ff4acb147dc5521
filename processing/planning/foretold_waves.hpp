#pragma once

#include <cstddef>
#include <vector>

#include "processing/base/bench.hpp"
#include "processing/base/material.hpp"
#include "processing/planning/planned_pulse.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// What a planned shot's waves do at the gauges and to the specimen, which stays in touch with both
/// bars.
struct ForetoldWaves {
  double step_s = 0.0;
  std::size_t steps_per_sample = 1;
  /// By gauge in the bench's order and step, from the record's start.
  std::vector<std::vector<double>> gauge_strain;
  /// The specimen's histories at the bench's rate, from the pulse's arrival until it is unloaded
  /// after the first loading, or the first wave is back from a far end if that is later.
  Reduction specimen;
};

/// @param quiet_s  from the record's start to the impact
/// @param returns_s  from the arrival at the specimen until the first wave is back there
[[nodiscard]] ForetoldWaves foretell_waves(const Bench& bench, const Material& bars,
                                           const Material& specimen, const PlannedPulse& pulse,
                                           double quiet_s, double returns_s);

}  // namespace kolsky

#pragma once

#include "drivers/simulated/scenario.hpp"

namespace kolsky {

/// Throws a scenario's ball: from where it is 10 mm before the outermost beam, through the beams,
/// on the bar and out again. The push is that of the axisymmetric finite elements on a plane with
/// the bar's impedance; the bar then carries it in the time domain. Photo-sensors follow the gauges
/// in `gauge_strain`, as the strain that stands for their volts.
/// @pre scenario.ball and scenario.bench.ball
[[nodiscard]] BenchHistory run_ball(const Scenario& scenario, double step_s, std::size_t steps);

}  // namespace kolsky

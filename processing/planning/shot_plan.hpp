#pragma once

#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/planning/planned_pulse.hpp"
#include "processing/reduction/loop_summary.hpp"
#include "processing/reduction/reduction.hpp"
#include "processing/reduction/validity.hpp"

namespace kolsky {

struct PlanOptions {
  double noise_strain = 5e-6;  ///< rms at the gauges
  /// No bar model was given: bars near enough to PMMA to be taken for it (see assumed_bars).
  bool bars_assumed = false;
};

/// What one gauge will show.
struct GaugeForecast {
  std::string name;
  std::string unit;  ///< of the readings
  double highest_strain = 0.0;
  double lowest_strain = 0.0;
  double highest_reading = 0.0;  ///< largest magnitude, for the amplifier's range
};

/// A shot before it is fired.
struct ShotPlan {
  PlannedPulse pulse;
  double window_s = 0.0;  ///< at the first gauge: the incident pulse alone
  /// Distance from the specimen at which a gauge sees all of the pulse before its reflection.
  double whole_pulse_m = 0.0;
  double returns_s = 0.0;  ///< from arrival at the specimen until a far end answers there
  double specimen_transit_s = 0.0;
  std::vector<GaugeForecast> gauges;
  Reduction specimen;    ///< what happens to it, until it is unloaded
  LoopSummary summary;   ///< of that
  Quotable equilibrium;  ///< the part of it in which both faces carry the same force
  Shot shot;             ///< as it would be recorded
  Reduction reduction;   ///< what a reduction would make of that; perhaps nothing
  Quotable quotable;     ///< of the reduction
};

/// Foretells a shot on a linear specimen, from the waves of the paper's model, the specimen's mass
/// included (of the bench's density, else of the material's): what happens to the specimen, what
/// the gauges read, and what a reduction of those records would see of the specimen.
/// @throws InputError where the bench has no specimen or no gauges
[[nodiscard]] ShotPlan plan_shot(const Bench& filed, const Material& bars, const Material& specimen,
                                 const PlannedPulse& pulse, const PlanOptions& options);

}  // namespace kolsky

#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "drivers/simulated/rod.hpp"

namespace kolsky {

/// The striker's force on the impacted end: raised-cosine rise, plateau, raised-cosine fall.
/// Afterwards the striker has left and the end is free.
struct ImpactPulse {
  double peak_force_N = 0.0;
  double duration_s = 170e-6;
  double ramp_s = 40e-6;

  [[nodiscard]] double force_N(double time_s) const;
};

enum class RodId { input, specimen, output };

struct GaugeStation {
  RodId rod = RodId::input;
  double position_m = 0.0;  ///< from the rod's end that is nearer to the impact
};

/// The apparatus as one line of rods in the time domain: input bar, specimen, output bar, of which
/// the last two may be missing. Faces touch at rest, pass pressure and no tension, part and meet
/// again; both outer ends are free.
struct BenchModel {
  RodShape input;
  std::optional<RodShape> specimen;
  std::optional<RodShape> output;
  ImpactPulse pulse;
  std::vector<double> push_N{};  ///< on the impacted end, by step; in the pulse's place where given
  std::vector<GaugeStation> gauges;
};

/// What the model knows of the specimen, at the steps' times from the arrival of the pulse's very
/// front at interface A. Compression is positive.
struct SpecimenHistory {
  std::vector<double> time_s;
  std::vector<double> stress_Pa;  ///< mean of both faces' forces over the specimen's area
  std::vector<double> strain;     ///< engineering, over its whole length
  std::vector<double> strain_rate_per_s;
  std::vector<double> force_front_N;
  std::vector<double> force_back_N;
};

/// What a ball did that struck the bar.
struct BallHistory {
  double touch_s = 0.0;         ///< from step 0 to first touch
  std::vector<double> time_s;   ///< from first touch
  std::vector<double> force_N;  ///< on the bar's face
  double peak_force_N = 0.0;
  double impulse_N_s = 0.0;
  double mass_kg = 0.0;
  double incident_speed_m_per_s = 0.0;
  double rebound_speed_m_per_s = 0.0;  ///< of the centre of mass
};

struct BenchHistory {
  double step_s = 0.0;
  std::vector<std::vector<double>>
      gauge_strain;  ///< per gauge, at step 0, 1, ...; step 0 is the impact
  std::optional<SpecimenHistory> specimen;
  std::optional<BallHistory> ball;
  double momentum_kg_m_per_s = 0.0;  ///< of all rods at the end
};

/// Runs the model for so many steps after the impact.
/// @throws std::invalid_argument where the step is longer than a rod's transit time
[[nodiscard]] BenchHistory run_bench(const BenchModel& model, double step_s, std::size_t steps);

}  // namespace kolsky

#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "tests/generators/ball_impact.hpp"

namespace kolsky::testing {

/// What a campaign of impacts holds, the hidden effect included.
struct ImpactWishes {
  std::uint64_t seed = 1;
  std::vector<double> speeds_m_per_s{31.1, 40.3, 51.0};
  std::size_t shots = 5;         ///< at each speed
  double speed_scatter = 0.006;  ///< relative, known: it is in the shot's facts
  double speed_error = 0.0;      ///< relative, of what the facts say, filed beside them
  double rebound_error = 1e-3;   ///< the same of the rebound speed
  double noise_strain = 1e-6;
  double bridge_b = 0.0;      ///< reading = e (1 + b e)
  double gauge_factor = 0.0;  ///< reading x (1 + kappa)
  double core_b = 0.0;
  double core_damage = 0.0;  ///< what it was strained to most softens it: in no library
  double core_D_per_Pa = 0.0;
  double core_tau_s = 1e-4;
  double cover_b = 0.0;
  double cover_D_per_Pa = 0.0;
  double cover_tau_s = 1e-4;
  /// E1, E2, eta2 of the core, then the cover, over the paper's.
  std::array<double, 6> moduli{1.0, 1.0, 1.0, 1.0, 1.0, 1.0};
  double friction = 0.3;
  double core_off_m = 0.0;     ///< true diameter less the filed one
  double ball_off_m = 0.0;     ///< the same of the whole ball
  double diameter_sd_m = 0.0;  ///< filed beside both
  double offset_m = 0.0;       ///< of the ball's axis from the bar's
  double bending_m =
      0.0;  ///< of the push's line from where gauges read no bending, times imbalance
  double sabot_mass_kg = 0.0;
  double drift_per_s = 0.0;  ///< reading + so much times the time since the trigger
  double hum_strain = 0.0;   ///< reading + a sine of 50 Hz, a phase of its own in each shot
  std::size_t across = 8;    ///< cells, see BallImpact
  bool rebound = true;
};

/// The paper's golf ball on its titanium bar (docs/benches/paper-impact.toml) in captures of 16
/// bits at 1 MHz, by a solver of its own; the far end reflects.
[[nodiscard]] std::vector<Shot> impact_shots(const ImpactWishes& wishes);

}  // namespace kolsky::testing

#pragma once

#include <cstddef>
#include <vector>

namespace kolsky::testing {

/// A layer's solid: J = 1/E1 + 1/(E2 + s eta2) + D/(1 + s tau), one Poisson's ratio for bulk and
/// shear; instantaneous deviatoric stress x (1 + b equivalent strain) (1 - damage x the largest
/// equivalent strain so far), the latter of no effect in the library.
struct BallSolid {
  double density_kg_m3 = 0.0;
  double poisson_ratio = 0.0;
  double E1_Pa = 0.0;
  double E2_Pa = 0.0;
  double eta2_Pa_s = 0.0;
  double D_per_Pa = 0.0;
  double tau_s = 0.0;
  double b = 0.0;
  double damage = 0.0;
};

struct BallImpact {
  double core_diameter_m = 0.0;
  double outer_diameter_m = 0.0;
  BallSolid core;
  BallSolid cover;
  double speed_m_per_s = 0.0;
  double friction = 0.3;
  double impedance_kg_per_s = 0.0;  ///< of the endless bar it strikes
  double target_radius_m = 0.0;
  double offset_m = 0.0;  ///< of the ball's axis; the cover that overhangs is let go as a bed of
                          ///< springs, bending is left out
  double sabot_mass_kg = 0.0;  ///< a rigid plane that follows at the ball's speed and pushes it
  std::size_t across = 8;      ///< cells over half the inner square's side
};

struct BallForce {
  double period_s = 0.0;
  std::vector<double> force_N;  ///< from first touch on
  double rebound_m_per_s = 0.0;
};

/// A ball on an endless bar by means that share nothing with processing/impact: triangles of
/// constant strain (every cell cut in four), hypoelastic in Jaumann's rate, Cauchy stress, penalty
/// at the nodes. @throws std::runtime_error where it runs away
[[nodiscard]] BallForce strike(const BallImpact& impact);

}  // namespace kolsky::testing

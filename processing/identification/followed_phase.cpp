#include "processing/identification/followed_phase.hpp"

#include <cmath>
#include <numbers>

namespace kolsky {

double FollowedPhase::at_next(double reading_rad, double variance_rad2) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  constexpr double kMoves_rad = 0.3;  // from one frequency to the next
  // Ten times the noise's power: noise alone reads so much once in twenty thousand times.
  constexpr double kTells_rad2 = 0.05;
  const double phase = reading_rad - kTurn * std::round((reading_rad - expected_rad_) / kTurn);
  variance_rad2_ += kMoves_rad * kMoves_rad;
  const double gain =
      variance_rad2 < kTells_rad2 ? variance_rad2_ / (variance_rad2_ + variance_rad2) : 0.0;
  expected_rad_ += gain * (phase - expected_rad_);
  variance_rad2_ *= 1.0 - gain;
  return phase;
}

}  // namespace kolsky

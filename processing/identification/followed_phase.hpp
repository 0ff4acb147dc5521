#pragma once

namespace kolsky {

/// A phase that moves slowly from one frequency to the next, known up to turns, followed upwards.
/// Where noise hides it (the lowest bins, a null of the pulse's spectrum) any reading may be half a
/// turn off, and two of these in a row a whole one, which every later frequency would keep. So a
/// reading moves what the next is unwrapped by only where it stands out of the noise, and as far
/// as it is better known than the way there: Kalman's filter of a random walk.
class FollowedPhase {
 public:
  /// @param reading_rad   with any number of turns
  /// @param variance_rad2 of its noise, by the reading's own size
  /// @return the reading with the turns that bring it nearest to what was followed
  [[nodiscard]] double at_next(double reading_rad, double variance_rad2);

 private:
  double expected_rad_ = 0.0;  ///< small before the first
  double variance_rad2_ = 1.0;
};

}  // namespace kolsky

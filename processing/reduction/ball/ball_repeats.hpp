#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "processing/reduction/ball/ball_impact.hpp"

namespace kolsky {

/// A number over repeats.
struct Repeated {
  double mean = 0.0;
  double sd = 0.0;  ///< of one repeat about the mean; 0 where there is but one
  std::size_t count = 0;
};

/// Impacts at nearly one speed.
struct BallRepeats {
  std::vector<std::size_t> members;  ///< indices into what was grouped
  Repeated speed_m_per_s;
  Repeated peak_force_N;
  Repeated contact_time_s;  ///< with a count of 0 where the thresholds differ
  double contact_threshold = 0.0;
  Repeated impulse_N_s;  ///< of those whose contact was over in the clean window
  Repeated restitution_by_speed;
  Repeated restitution_by_impulse;
};

/// Sorts impacts by their incident speed and parts them where neighbours differ by more than
/// `gap_share` of the slower one. Impacts without a speed belong to no group.
[[nodiscard]] std::vector<BallRepeats> group_by_speed(std::span<const BallImpact> impacts,
                                                      double gap_share = 0.05);

}  // namespace kolsky

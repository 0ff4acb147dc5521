#pragma once

#include <optional>
#include <string>

#include "processing/base/shot.hpp"

namespace kolsky {

/// How fast a ball came and went, as magnitudes.
struct BallFlight {
  std::optional<Measured> incident_m_per_s{};
  std::optional<Measured> rebound_m_per_s{};
  std::string source{};   ///< "meta" or "photo-sensors"; empty where nothing says
  std::string problem{};  ///< why a speed is missing, one line for people
};

/// The speeds of a ball that touches at `touch_s` (from the first sample): from the shot's
/// photo-sensors, else from its facts incident_speed_m_per_s and rebound_speed_m_per_s (with _sd).
///
/// A beam is clear at the touch, so that level is its bright one; an edge is where half of the
/// swing to the other level is passed. Two beams: their distance by the time between the same edge
/// in both, mean over blocking and clearing. One: the ball's diameter by how long it is in the
/// beam. A beam that more than one body passes on either side of the touch, and facts that the
/// photo-sensors contradict by more than 1 % and three deviations, give no speed and a `problem`.
/// @throws InputError where a fact is no number
[[nodiscard]] BallFlight ball_flight(const Shot& shot, double touch_s);

}  // namespace kolsky

#pragma once

#include <optional>

#include "processing/reduction/ball/ball_flight.hpp"
#include "processing/reduction/ball/ball_impact.hpp"

namespace kolsky {

/// Puts a ball's speeds beside its force, and the restitution that follows by speed and by impulse,
/// with deviations that count what both share once.
/// @param ball  with impulse and end of contact known
void set_speeds(const BallFlight& flight, const std::optional<Measured>& mass_kg, BallImpact& ball);

}  // namespace kolsky

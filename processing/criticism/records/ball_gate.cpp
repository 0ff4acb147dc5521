#include "processing/criticism/records/ball_gate.hpp"

#include "processing/base/error.hpp"
#include "processing/reduction/ball/ball_reducer.hpp"
#include "processing/reduction/formatted.hpp"

namespace kolsky {

namespace {

/// Of many captures, the one whose facts are refused is named.
Reduction reduced(const Shot& shot) {
  try {
    return BallReducer().reduce(shot, {});
  } catch (const InputError& error) {
    throw error.inside("capture " + shot.id);
  }
}

}  // namespace

std::string no_ball_does(const Shot& shot) {
  const Reduction reduction = reduced(shot);
  if (!reduction.quality.reducible) {
    return reduction.quality.reason;
  }
  const BallImpact& ball = *reduction.ball;
  if (!ball.incident_speed_m_per_s) {
    return {};
  }
  const double came = *ball.incident_speed_m_per_s;
  const double left = ball.rebound_speed_m_per_s ? ball.rebound_speed_m_per_s->value : 0.0;
  if (left >= came) {
    return formatted("the ball leaves at %.4g m/s, no slower than it came (%.4g m/s): ", left,
                     came) +
           "are the two exchanged?";
  }
  if (!ball.mass_kg) {
    return {};
  }
  // One where it sticks, two where it loses nothing; effects of gauges are looked for within.
  constexpr double kLeast = 0.7;
  constexpr double kMost = 2.6;
  const double share = ball.impulse_N_s / (*ball.mass_kg * came);
  if ((ball.contact_over && share < kLeast) || share > kMost) {
    return formatted("the impulse, %.4g N s, is %.3g of the momentum of %.4g g at %.4g m/s, ",
                     ball.impulse_N_s.value, share, 1e3 * *ball.mass_kg, came) +
           "where a ball gives 1 to 2: the speed's unit, the gauge's factor or the mass is off";
  }
  return {};
}

}  // namespace kolsky

#include "processing/reduction/ball/ball_speeds.hpp"

#include <cmath>

#include "processing/reduction/ball/ball_stations.hpp"

namespace kolsky {

namespace {

void set_restitution_by_impulse(BallImpact& ball) {
  const Measured& in = *ball.incident_speed_m_per_s;
  const Measured& mass = *ball.mass_kg;
  const Measured& impulse_N_s = ball.impulse_N_s;
  const double ratio = impulse_N_s / (mass * in);
  const double push_sd = std::hypot(relative_sd(impulse_N_s), relative_sd(mass));
  ball.restitution_by_impulse = Measured{ratio - 1.0, ratio * std::hypot(push_sd, relative_sd(in))};
  if (!ball.restitution_by_speed) {
    return;
  }
  const double e = *ball.restitution_by_speed;
  const Measured& out = *ball.rebound_speed_m_per_s;
  // The incident speed is in both: its error moves them by (e - ratio) times itself.
  ball.restitution_difference = Measured{
      e - ratio + 1.0,
      std::hypot(std::hypot(ratio * push_sd, e * relative_sd(out)), (ratio - e) * relative_sd(in))};
  const double change = mass * (in + out);
  const double momentum_ratio = impulse_N_s / change;
  const double speed_sd = std::hypot(in.sd, out.sd) / (in + out);
  ball.momentum_excess =
      Measured{momentum_ratio - 1.0, momentum_ratio * std::hypot(push_sd, speed_sd)};
}

}  // namespace

void set_speeds(const BallFlight& flight, const std::optional<Measured>& mass_kg,
                BallImpact& ball) {
  ball.speed_source = flight.source;
  ball.incident_speed_m_per_s = flight.incident_m_per_s;
  ball.rebound_speed_m_per_s = flight.rebound_m_per_s;
  ball.mass_kg = mass_kg;
  if (!flight.incident_m_per_s) {
    return;
  }
  const Measured& in = *flight.incident_m_per_s;
  if (flight.rebound_m_per_s) {
    const Measured& out = *flight.rebound_m_per_s;
    const double e = out / in;
    ball.restitution_by_speed = Measured{e, e * std::hypot(relative_sd(in), relative_sd(out))};
  }
  if (ball.mass_kg && ball.contact_over) {
    set_restitution_by_impulse(ball);
  }
}

}  // namespace kolsky

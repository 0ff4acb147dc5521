#include "drivers/simulated/ball_shot.hpp"

#include <algorithm>
#include <cmath>

#include "processing/impact/bench_impact.hpp"
#include "processing/impact/impact.hpp"

namespace kolsky {

namespace {

constexpr double kApproach_m = 0.01;
constexpr double kBeamWidth_m = 1e-3;
constexpr double kBlocked_V = 3.0;  // a clear beam reads 0

/// Force over time, linear between samples.
double force_at(const impact::ImpactHistory& history, double time_s) {
  const double interval_s = history.time_s[1] - history.time_s[0];
  const double place = (time_s - history.time_s.front()) / interval_s;
  if (place <= 0.0) {
    return time_s > 0.0 ? history.force_N.front() * time_s / history.time_s.front() : 0.0;
  }
  const auto n = static_cast<std::size_t>(place);
  if (n + 1 >= history.force_N.size()) {
    return 0.0;
  }
  const double share = place - static_cast<double>(n);
  return (1.0 - share) * history.force_N[n] + share * history.force_N[n + 1];
}

/// The ball's way as photo-sensors see it: rigid, at constant speed before and after the contact.
struct Flight {
  double touch_s;
  double release_s;  ///< from first touch
  double in_m_per_s;
  double out_m_per_s;
  double radius_m;

  [[nodiscard]] double centre_m(double time_s) const {
    const double since_s = time_s - touch_s;
    const double gap_m = since_s < 0.0         ? -in_m_per_s * since_s
                         : since_s < release_s ? 0.0
                                               : out_m_per_s * (since_s - release_s);
    return gap_m + radius_m;
  }

  [[nodiscard]] double volts(double distance_m, double time_s) const {
    const double inside_m = radius_m - std::abs(distance_m - centre_m(time_s));
    return kBlocked_V * std::clamp(inside_m / kBeamWidth_m + 0.5, 0.0, 1.0);
  }
};

double furthest_beam_m(const Bench& bench) {
  double furthest_m = 0.0;
  for (const PhotoSensor& sensor : bench.photo_sensors) {
    furthest_m = std::max<double>(furthest_m, sensor.distance_m);
  }
  return furthest_m;
}

}  // namespace

BenchHistory run_ball(const Scenario& scenario, double step_s, std::size_t steps) {
  const ThrownBall& ball = *scenario.ball;
  const impact::ImpactHistory history = impact::simulate(impact::impact_on(
      scenario.bench, {ball.core}, {ball.cover}, impact::TargetKind::dashpot, ball.speed_m_per_s));
  const Flight flight{(furthest_beam_m(scenario.bench) + kApproach_m) / ball.speed_m_per_s,
                      history.release_time_s, ball.speed_m_per_s, history.rebound_speed_m_per_s,
                      scenario.bench.ball->outer_diameter_m / 2.0};
  BenchModel model = scenario.model;
  model.push_N.resize(steps);
  for (std::size_t step = 0; step < steps; ++step) {
    model.push_N[step] = force_at(history, static_cast<double>(step) * step_s - flight.touch_s);
  }
  BenchHistory shot = run_bench(model, step_s, steps);
  for (const PhotoSensor& sensor : scenario.bench.photo_sensors) {
    std::vector<double>& record = shot.gauge_strain.emplace_back(steps);
    for (std::size_t step = 0; step < steps; ++step) {
      record[step] = scenario.front_end.strain_per_V() *
                     flight.volts(sensor.distance_m, static_cast<double>(step) * step_s);
    }
  }
  shot.ball = BallHistory{
      flight.touch_s,      history.time_s,  history.force_N,    history.peak_force_N,
      history.impulse_N_s, history.mass_kg, ball.speed_m_per_s, history.rebound_speed_m_per_s};
  return shot;
}

}  // namespace kolsky

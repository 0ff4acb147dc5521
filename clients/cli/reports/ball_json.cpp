#include <cmath>

#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/time_text.hpp"

namespace kolsky::cli {
namespace {

JsonValue describe_stations(const BallImpact& ball) {
  JsonList list;
  for (const ForceStation& station : ball.stations) {
    list.push_back(JsonObject{{"gauges", station.gauges},
                              {"position_m", station.position_m},
                              {"weight", station.weight},
                              {"clean_from_s", station.clean_from_s},
                              {"clean_until_s", station.clean_until_s},
                              {"noise_N", station.noise_N},
                              {"impulse_N_s", station.impulse_N_s}});
  }
  return list;
}

JsonValue describe_restitution(const BallImpact& ball) {
  JsonValue agree = nullptr;
  if (ball.restitution_difference) {
    agree = std::abs(*ball.restitution_difference) <= 3.0 * ball.restitution_difference->sd;
  }
  return JsonObject{{"by_speed", describe(ball.restitution_by_speed)},
                    {"by_impulse", describe(ball.restitution_by_impulse)},
                    {"difference", describe(ball.restitution_difference)},
                    {"agree", std::move(agree)}};
}

JsonObject numbers_of(const BallImpact& ball) {
  return {{"peak_force_N", ball.peak_force_N.value},
          {"peak_force_N_sd", ball.peak_force_N.sd},
          {"peak_time_s", ball.peak_time_s},
          {"contact_time_s", ball.contact_time_s.value},
          {"contact_time_s_sd", ball.contact_time_s.sd},
          {"contact_threshold_share", ball.contact_threshold},
          {"contact_over", ball.contact_over},
          {"impulse_N_s", ball.impulse_N_s.value},
          {"impulse_N_s_sd", ball.impulse_N_s.sd},
          {"incident_speed_m_per_s", describe(ball.incident_speed_m_per_s)},
          {"rebound_speed_m_per_s", describe(ball.rebound_speed_m_per_s)},
          {"speed_source", ball.speed_source},
          {"mass_kg", describe(ball.mass_kg)},
          {"restitution", describe_restitution(ball)},
          {"momentum_excess", describe(ball.momentum_excess)},
          {"low_pass_Hz", ball.low_pass_Hz},
          {"force_noise_N", ball.force_noise_N},
          {"clean_from_s", ball.clean_from_s},
          {"clean_until_s", ball.clean_until_s},
          {"stations", describe_stations(ball)}};
}

JsonValue describe(const BallRepeats& group, const std::vector<std::string>& names) {
  JsonList members;
  for (const std::size_t i : group.members) {
    members.push_back(names[i]);
  }
  return JsonObject{
      {"captures", std::move(members)},
      {"incident_speed_m_per_s", cli::describe(group.speed_m_per_s)},
      {"peak_force_N", cli::describe(group.peak_force_N)},
      {"contact_time_s", cli::describe(group.contact_time_s)},
      {"contact_threshold_share", group.contact_threshold},
      {"impulse_N_s", cli::describe(group.impulse_N_s)},
      {"restitution", JsonObject{{"by_speed", cli::describe(group.restitution_by_speed)},
                                 {"by_impulse", cli::describe(group.restitution_by_impulse)}}}};
}

}  // namespace

JsonValue describe(const std::optional<Measured>& number) {
  if (!number) {
    return nullptr;
  }
  return JsonObject{{"value", number->value}, {"sd", number->sd}};
}

JsonValue describe(const Repeated& number) {
  return JsonObject{{"mean", number.count > 0 ? JsonValue(number.mean) : JsonValue(nullptr)},
                    {"sd", number.count > 1 ? JsonValue(number.sd) : JsonValue(nullptr)},
                    {"count", static_cast<std::uint64_t>(number.count)}};
}

BallImpact ball_of(const ReducedShot& reduced) {
  return reduced.reduction.ball.value_or(BallImpact{});
}

JsonValue describe_ball(const ReducedShot& reduced) {
  const Reduction& reduction = reduced.reduction;
  const BallImpact ball = ball_of(reduced);
  JsonObject object = {{"capture", reduced.capture},
                       {"shot", reduced.shot.id},
                       {"time", iso_time(reduced.shot.utc_ns)},
                       {"meta", describe_meta(reduced.shot.meta)},
                       {"bar_model", reduction.bar_model},
                       {"arrival_s", reduction.arrival_s},
                       {"arrival_sigma_s", reduction.arrival_sigma_s},
                       {"band_limit_Hz", reduction.band_limit_Hz},
                       {"quality", describe_checks(reduction.quality)}};
  for (JsonMember& number : numbers_of(ball)) {
    object.push_back(std::move(number));
  }
  object.push_back({"time_s", ball.time_s});
  object.push_back({"force_N", ball.force_N});
  if (reduced.as_filed) {
    JsonObject before = {{"reducible", reduced.as_filed->quality.reducible},
                         {"verdict", verdict_name(reduced.as_filed->quality.verdict())}};
    for (JsonMember& number : numbers_of(reduced.as_filed->ball.value_or(BallImpact{}))) {
      before.push_back(std::move(number));
    }
    object.push_back({"bench", *reduced.bench});
    object.push_back({"as_filed", std::move(before)});
  }
  return object;
}

JsonValue describe_balls(const std::vector<ReducedShot>& shots) {
  JsonList impacts;
  std::vector<BallImpact> balls;
  std::vector<std::string> names;
  for (const ReducedShot& shot : shots) {
    impacts.push_back(describe_ball(shot));
    balls.push_back(ball_of(shot));
    names.push_back(shot.capture);
  }
  JsonList groups;
  for (const BallRepeats& group : group_by_speed(balls)) {
    groups.push_back(describe(group, names));
  }
  return JsonObject{{"impacts", std::move(impacts)}, {"groups", std::move(groups)}};
}

}  // namespace kolsky::cli

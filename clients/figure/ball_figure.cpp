#include "clients/figure/ball_figure.hpp"

#include "clients/figure/layout.hpp"

namespace kolsky {
namespace {

Panel impulse_panel(const BallImpact& ball) {
  Series series{"impulse", ball.time_s, {}};
  double sum_N_s = 0.0;
  const double interval_s = ball.time_s.size() > 1 ? ball.time_s[1] - ball.time_s[0] : 0.0;
  for (const double force_N : ball.force_N) {
    sum_N_s += force_N * interval_s;
    series.y.push_back(sum_N_s);
  }
  return {"impulse", {"time", "s"}, {"impulse", "N s"}, {std::move(series)}};
}

}  // namespace

Panel ball_force_panel(const BallImpact& ball) {
  return {
      "contact force", {"time", "s"}, {"force", "N"}, {{"measured", ball.time_s, ball.force_N}}};
}

Figure ball_figure(const Reduction& reduction, const std::string& title) {
  const BallImpact& ball = *reduction.ball;
  Figure figure{title, {}, {}};
  figure.notes.push_back("force on the bar's face, compression positive; low-passed at " +
                         with_unit(ball.low_pass_Hz, "Hz") +
                         "; known until the far end answers at " +
                         with_unit(ball.clean_until_s, "s"));
  for (const Check& check : reduction.quality.checks) {
    if (check.verdict != Verdict::pass) {
      figure.notes.push_back(check.name + ": " + check.text);
    }
  }
  figure.panels = {ball_force_panel(ball), impulse_panel(ball)};
  return figure;
}

}  // namespace kolsky

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/time_text.hpp"
#include "clients/figure/ball_figure.hpp"
#include "clients/figure/layout.hpp"
#include "clients/terminal/plot.hpp"

namespace kolsky::cli {
namespace {

constexpr int kPlotColumns = 100;
constexpr int kPlotRows = 14;

std::string with_sd(const Measured& number, const std::string& unit) {
  return with_deviation(number.value, number.sd, unit);
}

std::string speeds_text(const BallImpact& ball) {
  const auto one = [](const std::optional<Measured>& speed) {
    return speed ? fmt::format("{:.2f} ± {:.2f} m/s", speed->value, speed->sd)
                 : std::string("not known");
  };
  return "in " + one(ball.incident_speed_m_per_s) + ", out " + one(ball.rebound_speed_m_per_s) +
         (ball.speed_source.empty() ? "" : " (" + ball.speed_source + ")");
}

std::string restitution_text(const BallImpact& ball) {
  const auto one = [](const char* by, const std::optional<Measured>& e) {
    return e ? fmt::format("{:.4f} ± {:.4f} by {}", e->value, e->sd, by) : std::string();
  };
  const std::string speed = one("speed", ball.restitution_by_speed);
  const std::string impulse = one("impulse", ball.restitution_by_impulse);
  if (speed.empty() && impulse.empty()) {
    return "not known";
  }
  return speed + (speed.empty() || impulse.empty() ? "" : ", ") + impulse;
}

std::string numbers(const BallImpact& ball) {
  std::string text;
  text += report_row("peak force", fmt::format("{} at {}", with_sd(ball.peak_force_N, "N"),
                                               with_unit(ball.peak_time_s, "s")));
  text +=
      report_row("contact time", ball.contact_over ? fmt::format("{} above {:.0f} % of the peak",
                                                                 with_sd(ball.contact_time_s, "s"),
                                                                 100.0 * ball.contact_threshold)
                                                   : "longer than the clean window");
  text += report_row(
      "impulse", fmt::format("{:.4f} ± {:.4f} N s", ball.impulse_N_s.value, ball.impulse_N_s.sd));
  text += report_row("speeds", speeds_text(ball));
  text += report_row("restitution", restitution_text(ball));
  text += report_row("low-pass", with_unit(ball.low_pass_Hz, "Hz") + ", leaves " +
                                     with_unit(ball.force_noise_N, "N") + " rms of noise");
  for (const ForceStation& station : ball.stations) {
    text += report_row(
        "gauge " + station.gauges,
        fmt::format("at {}, clean from {} to {}, weight {:.2f}", with_unit(station.position_m, "m"),
                    with_unit(station.clean_from_s, "s"), with_unit(station.clean_until_s, "s"),
                    station.weight));
  }
  return text;
}

std::string mean_text(const Repeated& number, const char* format_mean, double factor) {
  if (number.count == 0) {
    return "";
  }
  std::string text = fmt::format(fmt::runtime(format_mean), factor * number.mean);
  if (number.count > 1) {
    text += " ± " + fmt::format(fmt::runtime(format_mean), factor * number.sd);
  }
  return text;
}

}  // namespace

std::string ball_report(const ReducedShot& reduced, const Terminal& terminal) {
  const Shot& shot = reduced.shot;
  std::string text = report_head(reduced, terminal);
  if (shot.bench.ball) {
    text += report_row("ball",
                       with_unit(shot.bench.ball->outer_diameter_m, "m") + " in diameter" +
                           (shot.bench.ball->mass_kg
                                ? ", " + fmt::format("{:.4g} g", 1e3 * *shot.bench.ball->mass_kg)
                                : std::string()));
  }
  if (reduced.reduction.ball) {
    text += numbers(*reduced.reduction.ball);
  }
  if (reduced.as_filed && reduced.as_filed->ball) {
    text += report_row("bench", *reduced.bench);
    text += report_row("as filed", with_sd(reduced.as_filed->ball->peak_force_N, "N") + " peak, " +
                                       restitution_text(*reduced.as_filed->ball));
  }
  text += verdicts_text(reduced.reduction.quality, terminal);
  if (!reduced.reduction.ball) {
    return text;
  }
  const int columns = std::min(terminal.columns, kPlotColumns);
  return text + "\n" +
         plot_text(ball_force_panel(*reduced.reduction.ball), {columns, kPlotRows},
                   terminal.colour);
}

std::string balls_report(const std::vector<ReducedShot>& shots, const Terminal& terminal) {
  std::vector<BallImpact> balls;
  std::string text;
  for (const ReducedShot& shot : shots) {
    balls.push_back(ball_of(shot));
    const Quality& quality = shot.reduction.quality;
    text +=
        inked(padded_right(verdict_name(quality.verdict()), 6), verdict_ink(quality.verdict()),
              terminal.colour) +
        (quality.reducible
             ? fmt::format("{} peak, {}; restitution {}", with_unit(balls.back().peak_force_N, "N"),
                           speeds_text(balls.back()), restitution_text(balls.back()))
             : quality.reason) +
        "  " + shot.capture + "\n";
  }
  text += "\nrepeats, mean and deviation of one\n";
  text += fmt::format("  {:>16}  {:>3}  {:>18}  {:>16}  {:>18}  {:>18}\n", "speed m/s", "n",
                      "peak kN", "contact us", "e by speed", "e by impulse");
  for (const BallRepeats& group : group_by_speed(balls)) {
    text += fmt::format("  {:>16}  {:>3}  {:>18}  {:>16}  {:>18}  {:>18}\n",
                        mean_text(group.speed_m_per_s, "{:.2f}", 1.0), group.speed_m_per_s.count,
                        mean_text(group.peak_force_N, "{:.3f}", 1e-3),
                        mean_text(group.contact_time_s, "{:.1f}", 1e6),
                        mean_text(group.restitution_by_speed, "{:.4f}", 1.0),
                        mean_text(group.restitution_by_impulse, "{:.4f}", 1.0));
  }
  return text;
}

}  // namespace kolsky::cli

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "clients/cli/reports/ball_report.hpp"
#include "clients/cli/reports/chain_run.hpp"
#include "clients/figure/layout.hpp"
#include "clients/terminal/plot.hpp"
#include "processing/identification/better_solid.hpp"

namespace kolsky::cli {
namespace {

constexpr int kPlotColumns = 100;
constexpr int kPlotRows = 12;

JsonValue describe(const std::vector<FittedNumber>& numbers,
                   const std::vector<std::vector<double>>& covariance, double chi2_reduced) {
  JsonObject parameters;
  for (const FittedNumber& number : numbers) {
    parameters.push_back({number.name, JsonObject{{"value", number.value}, {"sd", number.sd}}});
  }
  JsonList rows;
  for (const auto& row : covariance) {
    rows.push_back(row);
  }
  return JsonObject{{"parameters", std::move(parameters)},
                    {"covariance", std::move(rows)},
                    {"chi2_reduced", chi2_reduced}};
}

JsonValue describe(const Foretold& number) {
  return JsonObject{{"value", number.value}, {"sd", number.sd}, {"mesh", number.mesh}};
}

JsonValue describe(const std::optional<Compared>& pair) {
  if (!pair) {
    return nullptr;
  }
  return JsonObject{
      {"measured", JsonObject{{"value", pair->measured.value}, {"sd", pair->measured.sd}}},
      {"predicted", describe(pair->foretold)},
      {"z", pair->z()}};
}

JsonValue describe(const ChainSpeed& speed) {
  const BallPrediction& foretold = speed.foretold;
  return JsonObject{
      {"speed_m_per_s", foretold.asked.speed_m_per_s.value},
      {"shots", static_cast<std::uint64_t>(speed.measured.members.size())},
      {"predicted", JsonObject{{"peak_force_N", describe(foretold.peak_force_N)},
                               {"contact_time_s", describe(foretold.contact_time_s)},
                               {"impulse_N_s", describe(foretold.impulse_N_s)},
                               {"restitution", describe(foretold.restitution)},
                               {"failed_draws", static_cast<std::uint64_t>(foretold.failed)}}},
      {"peak_force_N", describe(speed.peak_force_N)},
      {"contact_time_s", describe(speed.contact_time_s)},
      {"impulse_N_s", describe(speed.impulse_N_s)},
      {"restitution", JsonObject{{"by_speed", describe(speed.restitution_by_speed)},
                                 {"by_impulse", describe(speed.restitution_by_impulse)}}},
      {"agrees",
       speed.furthest() ? JsonValue(std::abs(speed.furthest()->z) < kFarOff) : JsonValue(nullptr)},
      {"force_rms_share", speed.force_rms_share},
      {"force_sd_share", speed.force_sd_share},
      {"low_pass_Hz", foretold.asked.low_pass_Hz},
      {"contact_threshold_share", foretold.asked.contact_threshold},
      {"time_s", foretold.time_s},
      {"force_measured_N", speed.force_N},
      {"force_predicted_N", foretold.force_N},
      {"force_predicted_sd_N", foretold.force_sd_N}};
}

std::string material_line(const char* name, const std::vector<FittedNumber>& numbers,
                          double chi2_reduced) {
  std::string text = fmt::format("  {:<8}", name);
  for (const FittedNumber& number : numbers) {
    text += fmt::format("{} {:.5g} ± {:.2g} %   ", number.name, number.value,
                        100.0 * number.sd / number.value);
  }
  return text + fmt::format("chi2 {:.2f}\n", chi2_reduced);
}

struct Row {
  const char* name;
  const char* unit;
  double factor;
  int digits;
};

std::string row_text(const Row& row, const std::optional<Compared>& pair,
                     const Foretold& foretold) {
  const auto number = [&](double value) {
    return fmt::format("{:.{}f}", row.factor * value, row.digits);
  };
  std::string text = fmt::format("    {:<22}", row.name);
  text += fmt::format("{:>20}",
                      pair ? number(pair->measured) + " ± " + number(pair->measured.sd) : "-");
  text += fmt::format("{:>20}{:>10}", number(foretold.value) + " ± " + number(foretold.sd),
                      number(foretold.mesh));
  text += pair ? fmt::format("{:>8.1f}", pair->z()) : fmt::format("{:>8}", "");
  return text + "  " + row.unit + "\n";
}

std::string speed_text(const ChainSpeed& speed) {
  const BallPrediction& f = speed.foretold;
  std::string text =
      fmt::format("  {:.2f} m/s, {} shot{}\n", f.asked.speed_m_per_s.value,
                  speed.measured.members.size(), speed.measured.members.size() == 1 ? "" : "s");
  text +=
      fmt::format("    {:<22}{:>20}{:>20}{:>10}{:>8}\n", "", "measured", "foretold", "mesh", "z");
  text += row_text({"peak force", "kN", 1e-3, 3}, speed.peak_force_N, f.peak_force_N);
  text += row_text({"contact time", "us", 1e6, 1}, speed.contact_time_s, f.contact_time_s);
  text += row_text({"impulse", "N s", 1.0, 4}, speed.impulse_N_s, f.impulse_N_s);
  text += row_text({"restitution, speed", "", 1.0, 4}, speed.restitution_by_speed, f.restitution);
  text +=
      row_text({"restitution, impulse", "", 1.0, 4}, speed.restitution_by_impulse, f.restitution);
  if (!speed.measured.members.empty()) {
    text += fmt::format(
        "    force history         apart by {:.2f} % of the peak rms, foretold to {:.2f} %\n",
        100.0 * speed.force_rms_share, 100.0 * speed.force_sd_share);
  }
  if (f.failed > 0) {
    text +=
        fmt::format("    {} drawn balls did not survive the impact and are left out\n", f.failed);
  }
  return text;
}

/// The speed whose measurement is furthest from what was foretold; null where none is compared.
const ChainSpeed* furthest_of(const ChainRun& run) {
  const ChainSpeed* worst = nullptr;
  for (const ChainSpeed& speed : run.speeds) {
    if (speed.furthest() &&
        (worst == nullptr || std::abs(speed.furthest()->z) > std::abs(worst->furthest()->z))) {
      worst = &speed;
    }
  }
  return worst;
}

std::string verdict_text(const ChainRun& run) {
  const ChainSpeed* worst = furthest_of(run);
  if (worst == nullptr) {
    return {};
  }
  const ChainSpeed::Furthest furthest = *worst->furthest();
  const std::string where =
      fmt::format("{} at {:.1f} m/s is {:.1f} deviations off", furthest.name,
                  worst->foretold.asked.speed_m_per_s.value, std::abs(furthest.z));
  return std::abs(furthest.z) < kFarOff
             ? fmt::format("agrees: {}, and nothing further\n", where)
             : fmt::format(
                   "does not agree: {}, where chance alone stays within {:g}. A law, the "
                   "reading, friction or the geometry is another: `kolsky diagnose` on "
                   "the ball's captures tells which\n",
                   where, kFarOff);
}

JsonValue agreement_of(const ChainRun& run) {
  const ChainSpeed* worst = furthest_of(run);
  if (worst == nullptr) {
    return nullptr;
  }
  return std::abs(worst->furthest()->z) < kFarOff;
}

JsonValue describe_between(const ChainRun& run) {
  JsonList rows;
  for (const auto& row : run.between) {
    rows.push_back(std::vector<double>(row.begin(), row.end()));
  }
  return rows;
}

Panel panel_of(const ChainSpeed& speed) {
  const BallPrediction& f = speed.foretold;
  Panel panel{
      fmt::format("{:.1f} m/s", f.asked.speed_m_per_s.value), {"time", "s"}, {"force", "N"}, {}};
  if (!speed.force_N.empty()) {
    panel.series.push_back({"measured", f.time_s, speed.force_N});
  }
  panel.series.push_back({"foretold", f.time_s, f.force_N});
  return panel;
}

}  // namespace

std::optional<ChainSpeed::Furthest> ChainSpeed::furthest() const {
  std::optional<Furthest> worst;
  const auto look = [&](const char* name, const std::optional<Compared>& pair) {
    if (pair && (!worst || std::abs(pair->z()) > std::abs(worst->z))) {
      worst = Furthest{name, pair->z()};
    }
  };
  look("peak force", peak_force_N);
  look("contact time", contact_time_s);
  look("impulse", impulse_N_s);
  look("restitution by speed", restitution_by_speed);
  look("restitution by impulse", restitution_by_impulse);
  return worst;
}

double Compared::sd() const {
  return std::max(std::hypot(std::hypot(measured.sd, foretold.sd), foretold.mesh),
                  1e-12 * std::abs(measured.value));
}

JsonValue describe(const ChainRun& run) {
  JsonList speeds;
  for (const ChainSpeed& speed : run.speeds) {
    speeds.push_back(describe(speed));
  }
  JsonValue bar = nullptr;
  if (run.bar) {
    const BarFit& fit = fit_to_file(*run.bar);
    bar = describe(fit.parameters, fit.covariance, fit.chi2_reduced);
  }
  return JsonObject{
      {"bars", run.bars},
      {"bar", std::move(bar)},
      {"core", describe(run.core.parameters, run.core.covariance, run.core.chi2_reduced)},
      {"cover", describe(run.cover.parameters, run.cover.covariance, run.cover.chi2_reduced)},
      {"core_cover_covariance", describe_between(run)},
      {"agrees", agreement_of(run)},
      {"reading", impact::name_of(run.options.reading)},
      {"friction", run.options.friction},
      {"draws", static_cast<std::uint64_t>(run.options.draws)},
      {"elements", static_cast<std::uint64_t>(run.options.elements)},
      {"fine_elements", static_cast<std::uint64_t>(run.options.fine_elements)},
      {"speeds", std::move(speeds)},
      {"remarks", run.remarks}};
}

std::string report(const ChainRun& run, const Terminal& terminal) {
  std::string text = "bars: " + run.bars + "\n";
  if (run.bar) {
    const BarFit& fit = fit_to_file(*run.bar);
    text += material_line("bar", fit.parameters, fit.chi2_reduced);
  }
  text += material_line("core", run.core.parameters, run.core.chi2_reduced);
  text += material_line("cover", run.cover.parameters, run.cover.chi2_reduced);
  text +=
      fmt::format("\nball: {} draws of {} elements at each speed, reading {}, friction {:.2f}\n",
                  run.options.draws, run.options.elements, impact::name_of(run.options.reading),
                  run.options.friction);
  for (const ChainSpeed& speed : run.speeds) {
    text += speed_text(speed);
  }
  text += verdict_text(run);
  for (const std::string& remark : run.remarks) {
    for (const std::string& line : wrapped(remark, 96)) {
      text += "  " + line + "\n";
    }
  }
  const int columns = std::min(terminal.columns, kPlotColumns);
  for (const ChainSpeed& speed : run.speeds) {
    text += "\n" + plot_text(panel_of(speed), {columns, kPlotRows}, terminal.colour);
  }
  return text;
}

Figure chain_figure(const ChainRun& run) {
  Figure figure{"bar, specimens, ball", {}, {}};
  for (const ChainSpeed& speed : run.speeds) {
    const BallPrediction& f = speed.foretold;
    Panel panel = panel_of(speed);
    Series low{"foretold - 2 sd", f.time_s, {}};
    Series high{"foretold + 2 sd", f.time_s, {}};
    for (std::size_t n = 0; n < f.force_N.size(); ++n) {
      low.y.push_back(f.force_N[n] - 2.0 * f.force_sd_N[n]);
      high.y.push_back(f.force_N[n] + 2.0 * f.force_sd_N[n]);
    }
    panel.series.push_back(std::move(low));
    panel.series.push_back(std::move(high));
    figure.panels.push_back(std::move(panel));
  }
  figure.notes.push_back("bars " + run.bars + "; reading " + impact::name_of(run.options.reading));
  figure.notes.insert(figure.notes.end(), run.remarks.begin(), run.remarks.end());
  return figure;
}

}  // namespace kolsky::cli

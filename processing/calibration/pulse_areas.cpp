#include "processing/calibration/pulse_areas.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "processing/base/striker.hpp"
#include "processing/identification/known_unknowns.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/waves/bar_modes.hpp"

namespace kolsky {

namespace {

constexpr double kMargin_s = 15e-6;
/// A pulse is over where it has fallen to this share of its peak.
constexpr double kOver = 0.01;

/// Time from the first gauge's foot until a gauge's pulse arrives there.
double way_s(const Bench& bench, const Gauge& gauge, const std::vector<double>& speeds) {
  if (gauge.bar != "output") {
    return gauge.position_m / speeds[0];
  }
  return bench.input.length_m / speeds[0] +
         (way_to_m(bench, gauge) - bench.input.length_m) / speeds[1];
}

/// How long a gauge sees the first pulse alone.
double alone_s(const CalibrationPart& part, const Bench& bench, const Gauge& gauge,
               const std::vector<double>& speeds) {
  if (part.two_passes) {
    return (bench.gauges[1].position_m - bench.gauges[0].position_m) / speeds[0];
  }
  if (part.lay != BarsLay::together) {
    return 2.0 * (bench.input.length_m - gauge.position_m) / speeds[0];
  }
  if (bench.output->far_end != FarEnd::free) {
    return std::numeric_limits<double>::infinity();
  }
  if (gauge.bar == "output") {
    return 2.0 * (bench.output->length_m - gauge.position_m) / speeds[1];
  }
  return 2.0 * (bench.input.length_m - gauge.position_m) / speeds[0] +
         2.0 * bench.output->length_m / speeds[1];
}

/// Gauges whose pulses are. Of two passes at one gauge the second is over when the record is.
std::span<const Gauge> compared(const CalibrationPart& part, const Bench& bench) {
  return std::span(bench.gauges).first(part.two_passes ? 1 : bench.gauges.size());
}

struct Area {
  double value = 0.0;
  double sd = 0.0;
  bool over = true;  ///< the pulse is, at the end
};

Area area_of(const std::vector<double>& strain, std::size_t quiet, std::size_t first,
             std::size_t end, double period_s) {
  Area area;
  double peak = 0.0;
  for (std::size_t n = first; n < end; ++n) {
    area.value += strain[n] * period_s;
    peak = std::max(peak, std::abs(strain[n]));
  }
  const double noise = quiet_before(strain, quiet).noise_rms;
  const auto samples = static_cast<double>(end - first);
  area.sd = noise * period_s * std::sqrt(samples * (1.0 + samples / static_cast<double>(quiet)));
  const std::size_t tail = std::max<std::size_t>(8, (end - first) / 20);
  double rest = 0.0;
  for (std::size_t n = end - tail; n < end; ++n) {
    rest += strain[n] / static_cast<double>(tail);
  }
  area.over = std::abs(rest) < kOver * peak + 3.0 * noise / std::sqrt(static_cast<double>(tail));
  return area;
}

Measured mean_of(const std::vector<Measured>& values) {
  double weight = 0.0;
  double sum = 0.0;
  for (const Measured& value : values) {
    weight += 1.0 / (value.sd * value.sd);
    sum += value.value / (value.sd * value.sd);
  }
  return {sum / weight, std::sqrt(1.0 / weight)};
}

/// What the scatter of numbers of one thing says of their mean; nothing where it is no more than
/// their deviations have it.
/// @param relative_sd_each  what each has beside its own
double scatter_of_mean(const std::vector<Measured>& values, double mean, double relative_sd_each) {
  double chi2 = 0.0;
  double weight = 0.0;
  double squares = 0.0;
  for (const Measured& value : values) {
    const double off = value.value - mean;
    chi2 += std::pow(off / std::hypot(value.sd, relative_sd_each * mean), 2);
    weight += 1.0 / (value.sd * value.sd);
    squares += std::pow(off / value.sd, 2);
  }
  const double freedom = static_cast<double>(values.size()) - 1.0;
  return chi2 > freedom && freedom > 0.0 ? std::sqrt(squares / (weight * freedom)) : 0.0;
}

double modulus_at_rest(const Bar& bar, const BarPrior& bars) {
  if (bar.youngs_modulus_Pa) {
    return *bar.youngs_modulus_Pa;
  }
  return relaxed_modulus_Pa(bars.material);
}

double relative_sd_at_rest(const Bar& bar, const BarPrior& bars) {
  if (bar.youngs_modulus_Pa) {
    return relative_sd(*bar.youngs_modulus_Pa);
  }
  const auto& family = parameters_of(bars.material.solid);
  double most = 0.0;
  for (std::size_t i = 0; i < family.size(); ++i) {
    if (family[i].is == SolidParameter::Is::modulus) {
      most = std::max(most, relative_sd(bars.material.parameters[i]));
    }
  }
  return most;
}

/// Absolute gain of the first gauge from its areas and the strikers' momenta.
std::optional<MomentumCheck> momentum(const CalibrationPart& part, const Bench& bench,
                                      const std::string& gauge, const std::vector<Area>& areas,
                                      const BarPrior& bars, std::string& none_because) {
  const auto& striker = bench.striker;
  if (!striker || !striker->length_m || !striker->diameter_m || !striker->density_kg_m3) {
    none_because = "the bench has no [striker] with length, diameter and density";
    return std::nullopt;
  }
  if (part.lay == BarsLay::output_alone) {
    none_because = "the output bar was struck by hand";
    return std::nullopt;
  }
  const double density = *striker->density_kg_m3;
  const std::optional<double> share = impedance_share(*striker, bench.input);
  if (!share) {
    none_because =
        "the striker is not of the bar's material, and its impedance is not known: of elastic "
        "ones striker.youngs_modulus_Pa tells";
    return std::nullopt;
  }
  const double ratio = std::pow(*striker->diameter_m / bench.input.diameter_m.value, 2.0) * *share;
  const double area_m2 = std::acos(-1.0) * std::pow(striker->diameter_m->value, 2.0) / 4.0;
  const double mass_kg = density * area_m2 * *striker->length_m;
  const double passed = ratio < 1.0 ? 2.0 / (1.0 + ratio) : 1.0;
  std::vector<Measured> gains;
  double common =
      std::hypot(relative_sd(*striker->length_m), 2.0 * relative_sd(*striker->diameter_m),
                 relative_sd(*striker->density_kg_m3));
  common = std::hypot(common, relative_sd_at_rest(bench.input, bars),
                      2.0 * relative_sd(bench.input.diameter_m));
  if (striker->youngs_modulus_Pa && ratio < 1.0) {
    common =
        std::hypot(common, 0.5 * ratio / (1.0 + ratio) * relative_sd(*striker->youngs_modulus_Pa));
  }
  double of_speed = 0.0;
  for (std::size_t n = 0; n < part.shots.size(); ++n) {
    const auto speed = filed_striker_speed(part.shots[n]);
    if (speed && areas[n].over) {
      const double strain_s =
          passed * mass_kg * *speed / (bench.input.area_m2() * modulus_at_rest(bench.input, bars));
      gains.push_back({areas[n].value / strain_s, areas[n].sd / strain_s});
      of_speed = std::max(of_speed, relative_sd(*speed));
    }
  }
  if (gains.empty()) {
    none_because = "no shot has a striker speed and a pulse that is over before it comes back";
    return std::nullopt;
  }
  Measured mean = mean_of(gains);
  mean.sd = std::max(mean.sd, scatter_of_mean(gains, mean.value, of_speed));
  mean.sd = std::hypot(mean.sd, std::hypot(common, of_speed) * mean.value);
  return MomentumCheck{gauge, mean, gains.size()};
}

}  // namespace

PulseAreas pulse_areas(const CalibrationPart& part, const Campaign& campaign,
                       const BarPrior& bars) {
  PulseAreas result;
  const Bench& bench = campaign.bench;
  result.first_gauge = bench.gauges[campaign.reference].name;
  if (part.two_passes) {
    result.none_because = "one gauge has nothing to be compared with";
  }
  std::vector<double> speeds{
      front_speed_m_per_s(bench.input, *compliance_of(bench.input, bars.material))};
  if (bench.output) {
    speeds.push_back(
        front_speed_m_per_s(*bench.output, *compliance_of(*bench.output, bars.material)));
    const double in = bench.input.area_m2() * modulus_at_rest(bench.input, bars);
    const double out = bench.output->area_m2() * modulus_at_rest(*bench.output, bars);
    if (std::abs(out / in - 1.0) > 1e-3) {
      result.none_because = "the bars differ in section or modulus";
    }
  }
  double window_s = std::numeric_limits<double>::infinity();
  const double first_way_s = way_s(bench, bench.gauges[campaign.reference], speeds);
  for (const Gauge& gauge : compared(part, bench)) {
    const double delay_s = way_s(bench, gauge, speeds) - first_way_s;
    window_s = std::min(window_s, alone_s(part, bench, gauge, speeds));
    for (const CampaignShot& shot : campaign.shots) {
      const double left_s = static_cast<double>(shot.strain.front().size()) * campaign.period_s -
                            shot.foot_s - delay_s;
      window_s = std::min(window_s, left_s);
    }
  }
  result.window_s = window_s - 2.0 * kMargin_s;
  if (result.window_s < 4.0 * kMargin_s) {
    result.none_because = result.no_momentum_because = "waves come back before a pulse has passed";
    return result;
  }
  const auto samples = static_cast<std::size_t>(result.window_s / campaign.period_s);
  std::vector<std::vector<Area>> areas(compared(part, bench).size());
  for (std::size_t j = 0; j < areas.size(); ++j) {
    const double delay_s = way_s(bench, bench.gauges[j], speeds) - first_way_s;
    for (const CampaignShot& shot : campaign.shots) {
      const auto first = static_cast<std::size_t>(
          std::max(0.0, (shot.foot_s + delay_s - kMargin_s) / campaign.period_s));
      const std::size_t end = std::min(first + samples, shot.strain[j].size());
      areas[j].push_back(area_of(shot.strain[j], std::max<std::size_t>(1, shot.quiet_samples),
                                 first, end, campaign.period_s));
    }
  }
  const auto& reference = areas[campaign.reference];
  for (std::size_t j = 0; j < areas.size() && result.none_because.empty(); ++j) {
    std::vector<Measured> ratios;
    for (std::size_t n = 0; n < reference.size(); ++n) {
      if (areas[j][n].over && reference[n].over) {
        const double ratio = areas[j][n].value / reference[n].value;
        ratios.push_back({ratio, std::hypot(areas[j][n].sd, ratio * reference[n].sd) /
                                     std::abs(reference[n].value)});
      }
    }
    if (ratios.empty()) {
      result.none_because = "pulses are not over before they come back";
    } else if (j != campaign.reference) {
      result.ratios.push_back({bench.gauges[j].name, mean_of(ratios)});
    }
  }
  if (!result.none_because.empty()) {
    result.ratios.clear();
  }
  result.momentum = momentum(part, bench, bench.gauges[campaign.reference].name, reference, bars,
                             result.no_momentum_because);
  return result;
}

}  // namespace kolsky

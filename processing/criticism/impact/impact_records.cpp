#include "processing/criticism/impact/impact_records.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/criticism/impact/fine_grid.hpp"
#include "processing/criticism/search/quiet_slopes.hpp"
#include "processing/impact/filter.hpp"

namespace kolsky {

namespace {

constexpr double kUsualCutoff_Hz = 10e3;
constexpr double kLead_s = 60e-6;
constexpr double kLongest_s = 900e-6;   ///< after the arrival: contacts take 400 to 600 us
constexpr double kShortest_s = 200e-6;  ///< less of a pulse says little of the ball
constexpr double kClear_s = 30e-6;      ///< of a reflection's foot and of the record's ends
constexpr double kSameSpeed = 1.04;     ///< highest over lowest speed of a group
constexpr double kLeastSpread = 0.005;  ///< of the calculated speeds to either side of the mean
constexpr std::size_t kMostLags = 6;

std::vector<SpeedGroup> groups_of(const Campaign& campaign) {
  std::vector<std::size_t> order(campaign.shots.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto speed = [&](std::size_t n) { return *campaign.shots[n].facts.incident_speed_m_per_s; };
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return speed(a) < speed(b); });
  std::vector<SpeedGroup> groups;
  for (const std::size_t n : order) {
    if (groups.empty() || speed(n) > kSameSpeed * speed(groups.back().shots.front())) {
      groups.emplace_back();
    }
    groups.back().shots.push_back(n);
  }
  for (SpeedGroup& group : groups) {
    double sum = 0.0;
    for (const std::size_t n : group.shots) {
      sum += speed(n);
    }
    group.speed_m_per_s = sum / static_cast<double>(group.shots.size());
    for (const std::size_t n : group.shots) {
      group.faster.push_back(speed(n) / group.speed_m_per_s - 1.0);
    }
    group.low_m_per_s =
        std::min(speed(group.shots.front()), (1.0 - kLeastSpread) * group.speed_m_per_s);
    group.high_m_per_s =
        std::max(speed(group.shots.back()), (1.0 + kLeastSpread) * group.speed_m_per_s);
  }
  return groups;
}

/// Autocovariance of low-passed noise at multiples of `step` samples, from what is quiet.
class NoiseMeter {
 public:
  NoiseMeter(std::size_t step, double sigma_samples) : step_(step), sigma_(sigma_samples) {}

  /// @param slope  per sample, of all shots alike: what repeats is no noise
  void add(const std::vector<double>& raw, const std::vector<double>& filtered, std::size_t quiet,
           double slope) {
    const double middle = 0.5 * (static_cast<double>(quiet) - 1.0);
    double mean = 0.0;
    for (std::size_t n = 0; n < quiet; ++n) {
      mean += raw[n] / static_cast<double>(quiet);
    }
    const auto off = [&](const std::vector<double>& record, std::size_t n) {
      return record[n] - mean - slope * (static_cast<double>(n) - middle);
    };
    for (std::size_t n = 0; n < quiet; ++n) {
      raw_ += off(raw, n) * off(raw, n);
    }
    raw_count_ += static_cast<double>(quiet) - 1.0;
    const auto edge = static_cast<std::size_t>(std::ceil(4.0 * sigma_));
    if (quiet < 2 * edge + (kMostLags + 4) * step_) {
      return;
    }
    for (std::size_t lag = 0; lag <= kMostLags; ++lag) {
      for (std::size_t n = edge; n + lag * step_ < quiet - edge; ++n) {
        sums_[lag] += off(filtered, n) * off(filtered, n + lag * step_);
        counts_[lag] += 1.0;
      }
    }
  }

  [[nodiscard]] std::vector<double> covariance(double code) const {
    std::vector<double> out(kMostLags + 1);
    const double white = raw_ / std::max(raw_count_, 1.0) + code * code / 12.0;
    for (std::size_t lag = 0; lag <= kMostLags; ++lag) {
      const double apart = static_cast<double>(lag * step_) / sigma_;
      out[lag] = white / (2.0 * std::sqrt(std::numbers::pi) * std::max(sigma_, 0.3)) *
                 std::exp(-apart * apart / 4.0);
    }
    // Enough of it seen through the filter: its own colour, tapered so that it stays a covariance.
    if (counts_[0] > 20.0 * static_cast<double>(step_) && sums_[0] > 0.0) {
      for (std::size_t lag = 0; lag <= kMostLags; ++lag) {
        const double taper = 1.0 - static_cast<double>(lag) / static_cast<double>(kMostLags + 1);
        out[lag] = std::max(sums_[0] / counts_[0], 0.5 * out[0]) * taper *
                   (sums_[lag] / counts_[lag]) / (sums_[0] / counts_[0]);
      }
    }
    return out;
  }

 private:
  std::size_t step_;
  double sigma_;
  double raw_ = 0.0;
  double raw_count_ = 0.0;
  std::vector<double> sums_ = std::vector<double>(kMostLags + 1, 0.0);
  std::vector<double> counts_ = std::vector<double>(kMostLags + 1, 0.0);
};

/// Mean slope per sample of a gauge's quiet parts over the shots: a baseline that drifts in all of
/// them alike would pass for slow noise. Of fewer than three it may be noise.
double common_slope(const Campaign& campaign, std::size_t gauge) {
  if (campaign.shots.size() < 3) {
    return 0.0;
  }
  double sum = 0.0;
  for (const CampaignShot& shot : campaign.shots) {
    sum += slope_before(shot, shot.strain[gauge]) * campaign.period_s;
  }
  return sum / static_cast<double>(campaign.shots.size());
}

/// How long after the arrival at the reference gauge every gauge is free of what is not modelled.
double clear_s(const Campaign& campaign, JudgedStretch stretch) {
  const Bar& bar = campaign.bench.input;
  const double c0 = std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
  const double x0 = campaign.bench.gauges[campaign.reference].position_m;
  double least = kLongest_s;
  if (stretch == JudgedStretch::whole) {
    return 2.0 * bar.length_m / c0 - kClear_s;
  }
  for (const Gauge& gauge : campaign.bench.gauges) {
    least = std::min(least, (2.0 * bar.length_m - gauge.position_m - x0) / c0 - kClear_s);
  }
  return least;
}

/// Relative deviation of all speeds alike, from what the photo-sensors' bench files.
double common_speed_sd(const Bench& bench) {
  const std::vector<PhotoSensor>& beams = bench.photo_sensors;
  if (beams.size() == 2) {
    return std::hypot(beams[0].distance_m.sd, beams[1].distance_m.sd) /
           std::abs(beams[0].distance_m - beams[1].distance_m);
  }
  const bool timed = beams.size() == 1 && bench.ball;
  return timed ? bench.ball->outer_diameter_m.sd / bench.ball->outer_diameter_m : 0.0;
}

void read_speeds(const Campaign& campaign, ImpactRecords& records) {
  const Bar& bar = campaign.bench.input;
  records.wave_speed_m_per_s = std::sqrt(*bar.youngs_modulus_Pa / bar.density_kg_m3);
  records.common_speed_sd = common_speed_sd(campaign.bench);
  for (const CampaignShot& shot : campaign.shots) {
    const ShotFacts& facts = shot.facts;
    const double sd = facts.incident_speed_sd_m_per_s / *facts.incident_speed_m_per_s;
    const double own = sd * sd - records.common_speed_sd * records.common_speed_sd;
    records.own_speed_sd = std::max(records.own_speed_sd, std::sqrt(std::max(0.0, own)));
    records.rebound.emplace_back();
    if (facts.rebound_speed_m_per_s) {
      const double speed = std::abs(*facts.rebound_speed_m_per_s);
      const double alike = records.common_speed_sd * speed;
      const double variance = std::pow(facts.rebound_speed_sd_m_per_s, 2) - alike * alike;
      records.rebound.back() =
          Measured{speed / records.wave_speed_m_per_s,
                   std::sqrt(std::max(0.0, variance)) / records.wave_speed_m_per_s};
    }
  }
}

/// Where the gauges' samples are, so that they show the same force.
void read_travel(const Campaign& campaign, ImpactRecords& records) {
  const double x0_m = campaign.bench.gauges[campaign.reference].position_m;
  for (const Gauge& gauge : campaign.bench.gauges) {
    const double travel_s = (gauge.position_m - x0_m) / records.wave_speed_m_per_s;
    const double periods = std::floor(travel_s / records.window.period_s);
    records.behind.push_back(static_cast<int>(periods));
    records.later_s.push_back(travel_s - periods * records.window.period_s);
  }
}

}  // namespace

std::size_t ImpactRecords::unsaid_rebounds(std::size_t group) const {
  return static_cast<std::size_t>(std::count_if(groups[group].shots.begin(),
                                                groups[group].shots.end(),
                                                [&](std::size_t n) { return !rebound[n]; }));
}

std::size_t ImpactRecords::unsaid_rebounds() const {
  return static_cast<std::size_t>(std::count(rebound.begin(), rebound.end(), std::nullopt));
}

void ImpactRecords::judge_from(const std::vector<double>& touch_s) {
  const auto shots = static_cast<double>(touch_s.size());
  double after_touch_s = 0.0;
  for (std::size_t n = 0; n < touch_s.size(); ++n) {
    after_touch_s += (first_s[n] - touch_s[n]) / shots;
  }
  for (std::size_t n = 0; n < touch_s.size(); ++n) {
    first_s[n] = touch_s[n] + after_touch_s;
  }
  take_samples();
}

void ImpactRecords::take_samples() {
  for (std::size_t n = 0; n < low_passed.size(); ++n) {
    judged[n].resize(low_passed[n].size() * window.samples);
    peak[n] = 0.0;
    for (std::size_t j = 0; j < low_passed[n].size(); ++j) {
      for (std::size_t k = 0; k < window.samples; ++k) {
        double& own = judged[n][j * window.samples + k];
        own =
            between_samples(low_passed[n][j], judged_s(n, j, k) / sample_period_s, sample_period_s)
                .value;
        peak[n] = std::max(peak[n], std::abs(own));
      }
    }
  }
}

ImpactRecords read_impact_records(const Campaign& campaign, JudgedStretch stretch,
                                  double cutoff_Hz) {
  if (!campaign.bench.input.youngs_modulus_Pa) {
    throw InputError("bars.input.youngs_modulus_Pa", "is missing: the ball strikes an elastic bar",
                     "give the bar's modulus");
  }
  ImpactRecords records;
  const double period_s = campaign.period_s;
  records.sample_period_s = period_s;
  constexpr double kSamplesOfCutoff = 8.0;
  ImpactWindow& window = records.window;
  window.to_far_end_only = stretch == JudgedStretch::to_reflection;
  window.cutoff_Hz =
      std::min(cutoff_Hz > 0.0 ? cutoff_Hz : kUsualCutoff_Hz, 1.0 / (kSamplesOfCutoff * period_s));
  constexpr double kSamplesPerCycle = 3.0;
  const auto step = std::max<std::size_t>(
      1, static_cast<std::size_t>(1.0 / (kSamplesPerCycle * window.cutoff_Hz * period_s)));
  window.period_s = static_cast<double>(step) * period_s;
  const double sigma_samples =
      std::sqrt(std::numbers::ln2) / (2.0 * std::numbers::pi * window.cutoff_Hz) / period_s;

  records.groups = groups_of(campaign);
  records.group_of.resize(campaign.shots.size());
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    for (const std::size_t n : records.groups[g].shots) {
      records.group_of[n] = g;
    }
  }
  read_speeds(campaign, records);
  read_travel(campaign, records);
  // The same stretch of every shot.
  double lead_s = kLead_s;
  double after_s = clear_s(campaign, stretch);
  for (const CampaignShot& shot : campaign.shots) {
    lead_s = std::min(lead_s, shot.foot_s - 2.0 * period_s);
    const double end_s = static_cast<double>(shot.strain[0].size()) * period_s;
    after_s = std::min(after_s, end_s - kClear_s - shot.foot_s);
  }
  after_s -= *std::ranges::max_element(records.later_s);
  if (after_s < kShortest_s) {
    throw InputError("captures",
                     "leave less than 200 us after the arrival before the record ends or the far "
                     "end's reflection is back",
                     "record longer, or use a longer bar");
  }
  window.lead_s = std::floor(lead_s / period_s) * period_s;
  window.samples = static_cast<std::size_t>((window.lead_s + after_s) / window.period_s);
  std::vector<NoiseMeter> meters(campaign.gauges(), NoiseMeter(step, sigma_samples));
  std::vector<double> slopes;
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    slopes.push_back(common_slope(campaign, j));
  }
  for (const CampaignShot& shot : campaign.shots) {
    const auto first =
        static_cast<std::size_t>(std::lround((shot.foot_s - window.lead_s) / period_s));
    std::vector<std::vector<double>> own;
    for (std::size_t j = 0; j < campaign.gauges(); ++j) {
      std::vector<double> filtered = impact::low_passed(shot.strain[j], period_s, window.cutoff_Hz);
      meters[j].add(shot.strain[j], filtered, std::min(shot.quiet_samples, filtered.size()),
                    slopes[j]);
      own.push_back(std::move(filtered));
    }
    records.low_passed.push_back(std::move(own));
    records.first_s.push_back(static_cast<double>(first) * period_s);
  }
  records.judged.resize(campaign.shots.size());
  records.peak.resize(campaign.shots.size());
  records.take_samples();
  for (std::size_t j = 0; j < campaign.gauges(); ++j) {
    records.noise.push_back(meters[j].covariance(campaign.step[j]));
  }
  return records;
}

}  // namespace kolsky

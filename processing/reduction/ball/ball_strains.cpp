#include "processing/reduction/ball/ball_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/bridge/bridge.hpp"
#include "processing/reduction/finite.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/requested.hpp"
#include "processing/waves/band_limit.hpp"
#include "processing/waves/seen_modes.hpp"

namespace kolsky {

namespace {

/// A run above the level shorter than this is a spike.
constexpr double kShortestPulse_s = 5e-6;
/// The baseline is taken from so much before the wave: mains hum turns by a twentieth meanwhile.
constexpr double kBaseline_s = 1e-3;
/// Beyond it gauges show how the bar rings, not what the ball does (docs/impact.md).
constexpr double kHighestLowPass_Hz = 50e3;

}  // namespace

bool BallPass::find_wave() {
  std::vector<double> readings(shot_.samples());
  read_raw_station(shot_, stations_[0], readings);
  const auto width =
      std::max<std::size_t>(3, static_cast<std::size_t>(std::ceil(kShortestPulse_s * rate_Hz_)));
  const auto reach_samples = static_cast<std::size_t>(clean_samples(stations_[0]));
  if (options_.arrival_s) {
    foot_ = *options_.arrival_s * rate_Hz_;
    static_cast<void>(rise_after_foot(readings, foot_, reach_samples, rate_Hz_));
    return true;
  }
  // Nothing that a ball does to its bar is larger than its push: what is small before is a drift.
  constexpr double kLeastShare = 0.3;
  const auto rise = find_first_pulse(readings, width, reach_samples, kLeastShare);
  if (!rise) {
    return false;
  }
  const double baseline = quiet_before(readings, std::min<std::size_t>(rise->index, 32)).baseline;
  const std::size_t end = std::min(readings.size(), rise->index + reach_samples);
  for (std::size_t n = 0; n < end; ++n) {
    readings[n] = rise->sense * (readings[n] - baseline);
  }
  const double peak = *std::max_element(readings.begin() + static_cast<std::ptrdiff_t>(rise->index),
                                        readings.begin() + static_cast<std::ptrdiff_t>(end));
  foot_ = foot_of(readings, rise->index, peak, 0.0).index;
  return true;
}

std::size_t BallPass::quiet_samples(const BarStation& station) const {
  const double later =
      travel_samples(station.gauge_to_specimen_m - stations_[0].gauge_to_specimen_m);
  const double end = foot_ + later - kFootClearance_s * rate_Hz_;
  return std::min(shot_.samples(), static_cast<std::size_t>(std::max(0.0, end)));
}

bool BallPass::read_strains() {
  const auto baseline = static_cast<std::size_t>(kBaseline_s * rate_Hz_);
  strains_.assign(stations_.size(), std::vector<double>(shot_.samples()));
  noise_strain_.clear();
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    std::vector<double>& strain = strains_[i];
    const std::size_t quiet = quiet_samples(stations_[i]);
    read_station(shot_, stations_[i], quiet, strain);
    baseline_samples_ = std::max<std::size_t>(1, std::min(quiet, baseline));
    const std::span<const double> before(strain.data() + quiet - std::min(quiet, baseline),
                                         std::min(quiet, baseline));
    const double level = mean_of(before);
    for (double& value : strain) {
      value -= level;
    }
    noise_strain_.push_back(quiet_before(strain, quiet).noise_rms);
    if (!all_finite(strain)) {
      return false;
    }
  }
  return true;
}

std::span<const double> BallPass::wave_at(std::size_t i) const {
  const std::size_t quiet = quiet_samples(stations_[i]);
  const auto length = static_cast<std::size_t>(clean_samples(stations_[i]));
  const std::size_t most = std::min(length, t_.key.longest_pulse);
  return std::span<const double>(strains_[i])
      .subspan(quiet)
      .first(std::min(most, shot_.samples() - quiet));
}

void BallPass::choose_band() {
  const auto quietest = static_cast<std::size_t>(
      std::min_element(noise_strain_.begin(), noise_strain_.end()) - noise_strain_.begin());
  const std::span<const double> wave = wave_at(quietest);
  double limit_Hz = options_.band_limit_Hz.value_or(0.0);
  if (!options_.band_limit_Hz) {
    limit_Hz = std::min(kHighestLowPass_Hz, t_.band.from_noise(wave, noise_strain_[quietest]));
  }
  bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
  reach(kernels_, t_, bar_, options_.theory, stations_, bins_);
  if (options_.band_limit_Hz) {
    require_band_seen(limit_Hz, kernels_.blind_from_Hz);
  } else {
    limit_Hz = std::min(limit_Hz, highest_band_limit_Hz(kernels_.blind_from_Hz));
    bins_ = BandLimit::bins_within(t_.transform, limit_Hz);
  }
  reduction_.band_limit_Hz = limit_Hz;
  band_loss_ = t_.band.loss(wave, noise_strain_[quietest], limit_Hz);
  const auto largest = std::max_element(wave.begin(), wave.end());
  peak_strain_ = largest == wave.end() ? 0.0 : *largest;
  peak_over_noise_ = noise_strain_[quietest] > 0.0
                         ? std::max(peak_strain_, 1e-300) / noise_strain_[quietest]
                         : std::numeric_limits<double>::infinity();
}

}  // namespace kolsky

#include "processing/reduction/ball/ball_pass.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/reduction/ball/ball_stations.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

namespace {

constexpr double kLeastThreshold = 0.01;
constexpr double kThresholdOverNoise = 4.0;
constexpr std::size_t kFewestDraws = 20;

}  // namespace

double BallPass::threshold_for(double peak_N) const {
  const double allowed = kThresholdOverNoise * noise_N_ / peak_N;
  return std::max(kLeastThreshold, std::ceil(100.0 * allowed - 1e-9) / 100.0);
}

SampleRange BallPass::contact_span(const Stay& stay, std::size_t known) const {
  const double margin = 2.0 * BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
  const double end = stay.end + margin + 20e-6 * rate_Hz_;
  const std::size_t last = std::min(known, static_cast<std::size_t>(end));
  return {std::min(last, static_cast<std::size_t>(std::max(0.0, touch_ - margin))), last};
}

void BallPass::measure() {
  BallImpact& ball = *reduction_.ball;
  const std::span<const double> known = known_force();
  const std::size_t peak = peak_after_touch(known);
  ball.contact_threshold = threshold_for(known[peak]);
  const Stay stay = stay_above(known, peak, ball.contact_threshold * known[peak]);
  const SampleRange span = contact_span(stay, known.size());
  ball.contact_over = stay.over;
  ball.peak_force_N.value = known[peak];
  ball.peak_time_s = (static_cast<double>(peak) - touch_) * period_s_;
  ball.contact_time_s.value = (stay.end - stay.begin) * period_s_;
  ball.impulse_N_s.value = impulse(known, span);
  contact_end_s_ = (stay.end - touch_) * period_s_;
  find_deviations(known, stay, span);
  list_stations(span);
  look_after_contact(known, stay);
}

double BallPass::impulse(std::span<const double> force, const SampleRange& span) const {
  return std::accumulate(force.begin() + static_cast<std::ptrdiff_t>(span.begin),
                         force.begin() + static_cast<std::ptrdiff_t>(span.end), 0.0) *
         period_s_;
}

double BallPass::raw_noise_N() const {
  const double N_per_strain = bar_.area_m2() * *bar_.youngs_modulus_Pa;
  double variance = 0.0;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    variance += std::pow(weights_[i] * noise_strain_[i] * N_per_strain, 2);
  }
  return std::sqrt(variance);
}

double BallPass::scale_sd() const {
  double variance = std::pow(relative_sd(*bar_.youngs_modulus_Pa), 2) +
                    std::pow(2.0 * relative_sd(bar_.diameter_m), 2);
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    for (const std::size_t channel : stations_[i].channels) {
      const double share = weights_[i] / static_cast<double>(stations_[i].channels.size());
      variance += std::pow(share * gain_sd(shot_.bench.gauges[channel], peak_strain_), 2);
    }
  }
  return std::sqrt(variance);
}

void BallPass::find_deviations(std::span<const double> known, const Stay& stay,
                               const SampleRange& span) {
  BallImpact& ball = *reduction_.ball;
  const auto length = static_cast<double>(span.end - span.begin);
  const double baseline_N = raw_noise_N() / std::sqrt(static_cast<double>(baseline_samples_));
  double peak_sd = std::hypot(noise_N_, baseline_N);
  double impulse_sd =
      period_s_ * std::hypot(raw_noise_N() * std::sqrt(length), baseline_N * length);
  double contact_sd = 0.0;
  for (const double slope : stay.slopes) {
    contact_sd = std::hypot(contact_sd, slope > 0.0 ? noise_N_ * period_s_ / slope : 0.0);
  }
  const std::size_t needed = baseline_samples_ + (span.end - span.begin);
  if (quiet_force_.size() > needed + kFewestDraws) {
    const ForceDeviations drawn = drawn_deviations(
        known, {quiet_force_, baseline_samples_, period_s_}, ball.contact_threshold, span);
    peak_sd = std::max(peak_sd, drawn.peak_sd);
    impulse_sd = std::max(impulse_sd, drawn.impulse_sd);
    contact_sd = std::max(contact_sd, drawn.contact_sd);
  }
  const double scale = scale_sd();
  ball.peak_force_N.sd = std::hypot(peak_sd, scale * ball.peak_force_N);
  ball.impulse_N_s.sd = std::hypot(impulse_sd, scale * ball.impulse_N_s);
  ball.contact_time_s.sd = contact_sd;
}

void BallPass::list_stations(const SampleRange& span) {
  const double N_per_strain = bar_.area_m2() * *bar_.youngs_modulus_Pa;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    ForceStation station;
    station.gauges = names_of(stations_[i], shot_.bench);
    station.position_m = stations_[i].gauge_to_specimen_m;
    station.weight = weights_[i];
    station.clean_from_s = travel_samples(stations_[i].gauge_to_specimen_m) * period_s_;
    station.clean_until_s = station.clean_from_s + clean_samples(stations_[i]) * period_s_;
    station.noise_N = noise_strain_[i] * N_per_strain;
    station.impulse_N_s = impulse(forces_[i], span);
    reduction_.ball->stations.push_back(std::move(station));
  }
}

void BallPass::look_after_contact(std::span<const double> known, const Stay& stay) {
  const auto from = static_cast<std::size_t>(stay.end + kAfterContact_s * rate_Hz_);
  if (from >= known.size()) {
    return;
  }
  const auto after = known.subspan(from);
  after_contact_N_ = mean_of(after);
  const auto count = static_cast<double>(after.size());
  after_contact_sd_N_ =
      raw_noise_N() * std::sqrt(1.0 / count + 1.0 / static_cast<double>(baseline_samples_));
}

}  // namespace kolsky

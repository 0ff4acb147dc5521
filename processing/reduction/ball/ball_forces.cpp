#include "processing/reduction/ball/ball_pass.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/reduction/pulse.hpp"
#include "processing/waves/band_limit.hpp"

namespace kolsky {

namespace {

double rms(std::span<const double> values) {
  double squares = 0.0;
  for (const double value : values) {
    squares += value * value;
  }
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

}  // namespace

void BallPass::find_forces() {
  forces_.assign(stations_.size(), {});
  std::vector<double> late(shot_.samples() + t_.key.delay);
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    t_.transform.forward(strains_[i], t_.spectrum);
    t_.band.apply(reduction_.band_limit_Hz, t_.spectrum);
    for (std::size_t k = 0; k < bins_; ++k) {
      t_.spectrum[k] *= kernels_.force_of_strain[i][k];
    }
    std::fill(t_.spectrum.begin() + static_cast<std::ptrdiff_t>(bins_), t_.spectrum.end(), 0.0);
    t_.transform.inverse(t_.spectrum, late);
    forces_[i].assign(late.begin() + static_cast<std::ptrdiff_t>(t_.key.delay), late.end());
  }
}

void BallPass::weigh(const std::vector<bool>& chosen, std::vector<double>& force) {
  const bool noiseless =
      std::any_of(noise_strain_.begin(), noise_strain_.end(), [](double n) { return n <= 0.0; });
  weights_.assign(stations_.size(), 0.0);
  double sum = 0.0;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    weights_[i] = !chosen[i] ? 0.0 : noiseless ? 1.0 : std::pow(noise_strain_[i], -2);
    sum += weights_[i];
  }
  force.assign(shot_.samples(), 0.0);
  clean_ = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    weights_[i] /= sum;
    if (weights_[i] > 0.0) {
      clean_ = std::min(clean_, clean_samples(stations_[i]));
      for (std::size_t n = 0; n < force.size(); ++n) {
        force[n] += weights_[i] * forces_[i][n];
      }
    }
  }
}

bool BallPass::locate_touch(const std::vector<double>& force) {
  const double smear = BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
  const double there = foot_ - travel_samples(stations_[0].gauge_to_specimen_m);
  const auto begin = static_cast<std::size_t>(std::max(0.0, there - smear));
  const double last = std::min(there + clean_ - smear, static_cast<double>(known_samples()));
  if (last < static_cast<double>(begin) + 8.0) {
    return false;
  }
  const auto end = static_cast<std::size_t>(last);
  const std::span<const double> push(force.data(), end);
  const std::size_t peak = begin + index_of_largest(push.subspan(begin));
  const double deepest =
      *std::min_element(push.begin() + static_cast<std::ptrdiff_t>(begin), push.end());
  if (force[peak] <= 0.0 || -deepest > force[peak]) {
    return false;
  }
  std::size_t half = peak;
  while (half > 0 && force[half] > force[peak] / 2.0) {
    --half;
  }
  const std::size_t quiet_from = std::min(begin, static_cast<std::size_t>(std::max(0.0, smear)));
  const std::size_t quiet_to =
      static_cast<std::size_t>(std::max(static_cast<double>(quiet_from), there - 2.0 * smear));
  quiet_force_ = std::span<const double>(force).subspan(quiet_from, quiet_to - quiet_from);
  noise_N_ = rms(quiet_force_);
  const Foot foot = foot_of(push, half, force[peak], noise_N_);
  touch_ = foot.index;
  reduction_.arrival_s = touch_ * period_s_;
  reduction_.arrival_sigma_s = foot.sigma * period_s_;
  return true;
}

std::size_t BallPass::known_samples() const {
  double longest = 0.0;
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    if (weights_[i] > 0.0) {
      longest = std::max(longest, travel_samples(stations_[i].gauge_to_specimen_m));
    }
  }
  const double known = static_cast<double>(shot_.samples()) - longest -
                       BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
  return static_cast<std::size_t>(std::max(0.0, known));
}

void BallPass::choose_stations() {
  double longest = 0.0;
  for (const BarStation& station : stations_) {
    longest = std::max(longest, clean_samples(station));
  }
  std::vector<bool> chosen(stations_.size());
  for (std::size_t i = 0; i < stations_.size(); ++i) {
    chosen[i] = clean_samples(stations_[i]) >= longest;
  }
  weigh(chosen, force_);
  if (locate_touch(force_) && holds_push()) {
    const std::span<const double> known = known_force();
    const std::size_t peak = peak_after_touch(known);
    const Stay stay = stay_above(known, peak, threshold_for(known[peak]) * known[peak]);
    const double needed = stay.end - touch_ + (kAfterContact_s + 20e-6) * rate_Hz_;
    for (std::size_t i = 0; i < stations_.size(); ++i) {
      chosen[i] = chosen[i] || clean_samples(stations_[i]) >= needed;
    }
  }
  weigh(chosen, force_);
}

std::span<const double> BallPass::known_force() const {
  const double smear = BandLimit::smear_s(reduction_.band_limit_Hz) * rate_Hz_;
  const double last = std::min(touch_ + clean_ - smear, static_cast<double>(known_samples()));
  return std::span<const double>(force_).first(
      static_cast<std::size_t>(std::clamp(last, 0.0, static_cast<double>(force_.size()))));
}

std::size_t BallPass::peak_after_touch(std::span<const double> known) const {
  const auto first = static_cast<std::size_t>(touch_);
  return first + index_of_largest(known.subspan(first));
}

bool BallPass::holds_push() const {
  constexpr double kFewestSamples = 8.0;
  return static_cast<double>(known_force().size()) > touch_ + kFewestSamples;
}

void BallPass::fill_history() {
  BallImpact& ball = reduction_.ball.emplace();
  const std::span<const double> known = known_force();
  const auto first = static_cast<std::size_t>(std::ceil(touch_));
  auto count = known.size() > first ? known.size() - first : 0;
  if (options_.duration_s) {
    count = std::min(count, static_cast<std::size_t>(*options_.duration_s * rate_Hz_) + 1);
  }
  for (std::size_t n = first; n < first + count; ++n) {
    ball.time_s.push_back((static_cast<double>(n) - touch_) * period_s_);
    ball.force_N.push_back(known[n]);
  }
  ball.low_pass_Hz = reduction_.band_limit_Hz;
  ball.force_noise_N = noise_N_;
  ball.clean_from_s = travel_samples(stations_[0].gauge_to_specimen_m) * period_s_;
  ball.clean_until_s = clean_ * period_s_;
}

}  // namespace kolsky

#include "processing/waves/band_limit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kolsky {

namespace {

constexpr std::size_t kBins = 24;  // averaged to judge the power at a frequency
// Of the sampling rate. At half the rate a delay by a part of a sample jumps; the filter is down to
// 1e-12 there, so that undamping the end of a record does not raise the jump above the signal.
constexpr double kHighestShare = 0.2;
constexpr double kStepsPerOctave = 12.0;  // limits are of a grid, so that filters can be kept
constexpr std::size_t kMostFilters = 64;

/// w_c of exp(-(w / w_c)^4) that passes half at the limit.
double corner_per_s(double limit_Hz) {
  return 2.0 * std::numbers::pi * limit_Hz / std::pow(std::numbers::ln2, 0.25);
}

void multiply(const std::vector<Complex>& gains, std::span<Complex> spectrum) {
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    spectrum[k] *= gains[k];
  }
}

}  // namespace

BandLimit::BandLimit(const DampedTransform& transform, std::size_t pulse_samples)
    : sampling_frequency_Hz_(transform.bin_width_Hz() * static_cast<double>(transform.length())),
      pulse_transform_(pulse_samples, 1.0 / sampling_frequency_Hz_, 1.0),
      pulse_spectrum_(pulse_transform_.bins()) {
  s_.reserve(transform.bins());
  for (std::size_t k = 0; k < transform.bins(); ++k) {
    s_.push_back(transform.s(k));
  }
}

double BandLimit::from_noise(std::span<const double> pulse, double noise_rms,
                             double power_over_noise) {
  const double highest_Hz = sampling_frequency_Hz_ * kHighestShare;
  if (noise_rms <= 0.0) {
    return highest_Hz;
  }
  pulse_transform_.forward(pulse, pulse_spectrum_);
  const double bin_Hz = pulse_transform_.bin_width_Hz();
  const auto top =
      std::min(static_cast<std::size_t>(highest_Hz / bin_Hz), pulse_spectrum_.size() - 1);
  if (top <= kBins) {
    return highest_Hz;
  }
  const double quiet = noise_rms * noise_rms * static_cast<double>(pulse.size());
  const double threshold =
      power_over_noise * std::max(quiet, floor_below(top)) * static_cast<double>(kBins);
  // Upwards from the pulse: what hums far above it is no part of it.
  std::size_t low = 0;
  double power = 0.0;
  for (std::size_t k = 0; k < kBins; ++k) {
    power += std::norm(pulse_spectrum_[k]);
  }
  while (power >= threshold && low + kBins < top) {
    power += std::norm(pulse_spectrum_[low + kBins]) - std::norm(pulse_spectrum_[low]);
    ++low;
  }
  const double limit_Hz = (static_cast<double>(low) + kBins / 2.0) * bin_Hz;
  const double steps = std::ceil(kStepsPerOctave * std::log2(highest_Hz / limit_Hz));
  return highest_Hz * std::exp2(-std::max(0.0, steps) / kStepsPerOctave);
}

/// Power per bin in the highest octave, of what is noise there: the median, which a few lines do
/// not move.
double BandLimit::floor_below(std::size_t top) {
  floor_.clear();
  for (std::size_t k = top / 2; k < top; ++k) {
    floor_.push_back(std::norm(pulse_spectrum_[k]));
  }
  const auto middle = floor_.begin() + static_cast<std::ptrdiff_t>(floor_.size() / 2);
  std::nth_element(floor_.begin(), middle, floor_.end());
  return *middle / std::numbers::ln2;  // noise's power is exponentially distributed
}

double BandLimit::loss(std::span<const double> pulse, double noise_rms, double limit_Hz) {
  pulse_transform_.forward(pulse, pulse_spectrum_);
  const double noise = noise_rms * noise_rms * static_cast<double>(pulse.size());
  const double wc = corner_per_s(limit_Hz);
  double all = 0.0;
  double taken = 0.0;
  for (std::size_t k = 0; k < pulse_spectrum_.size(); ++k) {
    const double energy = std::norm(pulse_spectrum_[k]) - noise;
    const double square = std::pow(pulse_transform_.s(k).imag() / wc, 2);
    const double kept = std::exp(-square * square);
    all += energy;
    taken += energy * (1.0 - kept * kept);
  }
  return all > 0.0 ? std::clamp(taken / all, 0.0, 1.0) : 0.0;
}

double BandLimit::weighed_energy(std::span<const double> pulse, double noise_rms, double limit_Hz,
                                 const std::function<double(double)>& weight) {
  pulse_transform_.forward(pulse, pulse_spectrum_);
  const double noise = noise_rms * noise_rms * static_cast<double>(pulse.size());
  const std::size_t bins =
      std::min(bins_within(pulse_transform_, limit_Hz), pulse_spectrum_.size());
  const double wc = corner_per_s(limit_Hz);
  double sum = 0.0;
  for (std::size_t k = 0; k < bins; ++k) {
    const double w = pulse_transform_.s(k).imag();
    const double square = std::pow(w / wc, 2);
    sum += (std::norm(pulse_spectrum_[k]) - noise) * std::exp(-2.0 * square * square) *
           weight(w / (2.0 * std::numbers::pi));
  }
  // A line stands for both signs of its frequency.
  return std::max(0.0, 2.0 * sum / static_cast<double>(pulse_transform_.length()));
}

const BandLimit::Filter& BandLimit::filter(double limit_Hz) {
  const auto known = filters_.find(limit_Hz);
  if (known != filters_.end()) {
    return known->second;
  }
  if (filters_.size() >= kMostFilters) {
    filters_.clear();
  }
  const double wc = corner_per_s(limit_Hz);
  Filter filter{std::vector<Complex>(s_.size()), std::vector<Complex>(s_.size())};
  for (std::size_t k = 0; k < s_.size(); ++k) {
    const Complex square = s_[k] * s_[k] / (wc * wc);
    filter.half[k] = std::exp(-square * square / 2.0);
    filter.whole[k] = filter.half[k] * filter.half[k];
  }
  return filters_.emplace(limit_Hz, std::move(filter)).first->second;
}

void BandLimit::apply(double limit_Hz, std::span<Complex> spectrum) {
  multiply(filter(limit_Hz).whole, spectrum);
}

void BandLimit::apply_half(double limit_Hz, std::span<Complex> spectrum) {
  multiply(filter(limit_Hz).half, spectrum);
}

double BandLimit::noise_share(double limit_Hz) const {
  // Integral of |H|^2 over frequency: Gamma(5/4) 2^(-1/4) of the corner.
  constexpr double kBandwidthOfCorner = 0.9064024770554771 * 0.8408964152537145;
  const double bandwidth_Hz =
      kBandwidthOfCorner * corner_per_s(limit_Hz) / (2.0 * std::numbers::pi);
  return std::sqrt(std::min(1.0, 2.0 * bandwidth_Hz / sampling_frequency_Hz_));
}

std::size_t BandLimit::bins_within(const DampedTransform& transform, double limit_Hz) {
  constexpr double kNothingFrom = 2.8;
  const auto bins =
      static_cast<std::size_t>(kNothingFrom * limit_Hz / transform.bin_width_Hz()) + 2;
  return std::min(bins, transform.bins());
}

double BandLimit::falls_to(double share) {
  return std::pow(-std::log(share) / std::numbers::ln2, 0.25);
}

double BandLimit::smear_s(double limit_Hz) {
  return 2.0 / corner_per_s(limit_Hz);
}

double BandLimit::reach_s(double limit_Hz) {
  return 3.0 * smear_s(limit_Hz);
}

}  // namespace kolsky

#include "processing/uncertainty/noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/reduction/pulse.hpp"

namespace kolsky {

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream)
    : state_(seed * 0x9E3779B97F4A7C15ULL + stream * 0xD1342543DE82EF95ULL + 1) {
  for (int i = 0; i < 4; ++i) {
    (void)next();
  }
}

/// Steele, Lea and Flood's SplitMix64.
std::uint64_t RandomStream::next() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31U);
}

double RandomStream::normal() {
  constexpr double kUnit = 1.0 / 9007199254740992.0;  // 2^-53
  const double u = (static_cast<double>(next() >> 11U) + 0.5) * kUnit;
  const double v = static_cast<double>(next() >> 11U) * kUnit;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

/// The sum of four uniform numbers of 16 bits.
double RandomStream::cheap_normal() {
  const std::uint64_t bits = next();
  const auto sum = static_cast<double>((bits & 0xFFFFU) + ((bits >> 16U) & 0xFFFFU) +
                                       ((bits >> 32U) & 0xFFFFU) + (bits >> 48U));
  constexpr double kMean = 2.0 * 65535.0;
  const double sd = std::sqrt(4.0 / 12.0) * 65536.0;
  return (sum - kMean) / sd;
}

NoiseMaker::NoiseMaker(std::span<const double> quiet, std::size_t samples)
    : rms_(quiet_before(quiet, quiet.size()).noise_rms) {
  const NoiseSpectrum spectrum({quiet});
  white_ = spectrum.order() == 0;
  if (white_) {
    return;
  }
  transform_.emplace(samples, 1.0, 1.0);
  spectrum_.resize(transform_->bins());
  // Nothing slower than the stretch is long shows in it: there noise is taken to be as strong as
  // at the slowest that does. Slow parts drawn out beyond that made equal shots' bands differ
  // threefold, by what a few samples happened to do.
  const double slowest = 1.0 / static_cast<double>(std::max<std::size_t>(quiet.size(), 1));
  for (std::size_t k = 0; k < transform_->bins(); ++k) {
    const double cycles = transform_->s(k).imag() / (2.0 * std::numbers::pi);
    gain_.push_back(std::sqrt(spectrum.power(std::max(cycles, slowest))));
  }
}

void NoiseMaker::make(RandomStream& random, std::vector<double>& noise) {
  for (double& value : noise) {
    value = random.cheap_normal();
  }
  if (white_) {
    for (double& value : noise) {
      value *= rms_;
    }
    return;
  }
  transform_->forward(noise, spectrum_);
  for (std::size_t k = 0; k < spectrum_.size(); ++k) {
    spectrum_[k] *= gain_[k];
  }
  transform_->inverse(spectrum_, noise);
}

}  // namespace kolsky

#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky::signals {

/// What a gauge channel shows without a shot, in codes and samples.
struct Background {
  double noise_codes = 20.0;    ///< rms of the random part
  double memory = 0.0;          ///< correlation from one sample to the next, 0 white
  double hum_codes = 0.0;       ///< amplitude
  double hum_period = 20e3;     ///< in samples
  double harmonic_codes = 0.0;  ///< amplitude at five times the hum's frequency
  double spikes = 0.0;          ///< probability per sample
  double spike_codes = 0.0;     ///< largest, either sign
  int spike_samples = 1;        ///< longest
  double offset_codes = 0.0;
};

/// Draws a background sample by sample, the same for the same seed.
class Source {
 public:
  Source(const Background& background, std::uint64_t seed)
      : background_(background), random_(seed), tick_(0) {
    phase_ = uniform() * 2.0 * std::numbers::pi;
    coloured_ = normal_(random_);
  }

  double next() {
    const Background& b = background_;
    const double fresh = normal_(random_);
    coloured_ = b.memory * coloured_ + std::sqrt(1.0 - b.memory * b.memory) * fresh;
    const double turn = 2.0 * std::numbers::pi * static_cast<double>(tick_) / b.hum_period + phase_;
    double value = b.offset_codes + b.noise_codes * coloured_;
    if (b.hum_codes != 0.0) value += b.hum_codes * std::sin(turn);
    if (b.harmonic_codes != 0.0) value += b.harmonic_codes * std::sin(5.0 * turn);
    if (b.spikes > 0.0) value += spike();
    ++tick_;
    return value;
  }

  double uniform() { return std::uniform_real_distribution<double>()(random_); }

 private:
  double spike() {
    if (spike_left_ == 0 && uniform() < background_.spikes) {
      spike_left_ = 1 + static_cast<int>(uniform() * background_.spike_samples);
      spike_height_ = background_.spike_codes * (2.0 * uniform() - 1.0);
    }
    if (spike_left_ == 0) return 0.0;
    --spike_left_;
    return spike_height_;
  }

  Background background_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  Tick tick_;
  double phase_ = 0.0;
  double coloured_ = 0.0;
  int spike_left_ = 0;
  double spike_height_ = 0.0;
};

/// A pulse with raised-cosine flanks; its foot is at zero.
struct Pulse {
  double peak_codes = 1000.0;
  double rise = 30.0;     ///< samples from foot to peak
  double length = 170.0;  ///< samples from foot to end

  [[nodiscard]] double at(double samples) const {
    if (samples <= 0.0 || samples >= length) return 0.0;
    const double flank = std::min({samples, length - samples, rise}) / rise;
    return 0.5 * peak_codes * (1.0 - std::cos(std::numbers::pi * flank));
  }
  /// When the rising flank reaches a height.
  [[nodiscard]] double reaches(double codes) const {
    return rise / std::numbers::pi * std::acos(1.0 - 2.0 * codes / peak_codes);
  }
};

template <class Code = std::int16_t>
Code quantised(double value, double lowest = -32768.0, double highest = 32767.0) {
  return static_cast<Code>(std::lround(std::clamp(value, lowest, highest)));
}

}  // namespace kolsky::signals

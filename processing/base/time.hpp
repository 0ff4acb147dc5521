#pragma once

#include <cstdint>

namespace kolsky {

/// Index of a sample since the stream began; missing samples are counted, so ticks are time.
using Tick = std::int64_t;

/// Samples per second as a rational number, so that an index and a rate give a time without drift.
struct SampleRate {
  std::int64_t numerator = 0;    ///< samples
  std::int64_t denominator = 1;  ///< seconds

  [[nodiscard]] double Hz() const noexcept {
    return static_cast<double>(numerator) / static_cast<double>(denominator);
  }
  /// Seconds from one sample to the next.
  [[nodiscard]] double period_s() const noexcept {
    return static_cast<double>(denominator) / static_cast<double>(numerator);
  }
  /// The rational nearest to a rate in Hz: exact for whole hertz, else to 1e-6 Hz.
  /// Non-positive or non-finite rates give {0, 1}.
  static SampleRate from_Hz(double rate_Hz) noexcept;

  friend bool operator==(const SampleRate&, const SampleRate&) = default;
};

}  // namespace kolsky

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "processing/identification/noise_spectrum.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// Random numbers that a seed and a stream fix.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream);
  [[nodiscard]] std::uint64_t next();
  /// Of unit variance, normal.
  [[nodiscard]] double normal();
  /// Of unit variance; nearly normal in the centre, never beyond 3.5. For noise that the reduction
  /// averages over many samples, which makes it normal.
  [[nodiscard]] double cheap_normal();

 private:
  std::uint64_t state_;
};

/// Makes noise like that of a record before its pulse.
class NoiseMaker {
 public:
  /// @param quiet    the record's values before the pulse
  /// @param samples  length of what is made
  NoiseMaker(std::span<const double> quiet, std::size_t samples);

  void make(RandomStream& random, std::vector<double>& noise);

 private:
  double rms_ = 0.0;
  bool white_ = true;
  std::optional<DampedTransform> transform_;
  std::vector<double> gain_;  ///< per bin
  std::vector<Complex> spectrum_;
};

}  // namespace kolsky

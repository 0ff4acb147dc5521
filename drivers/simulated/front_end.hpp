#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "processing/base/time.hpp"

namespace kolsky {

/// What stands between the strain at a gauge and a code: bridge and amplifier with their faults,
/// and a converter that rounds and clips. Linear, so a code is a voltage and a strain alike.
struct FrontEndSettings {
  int bits = 16;
  double range_microstrain = 2000.0;  ///< strain at the converter's ends
  double full_scale_V = 5.0;          ///< volts at the converter's ends
  double noise_microstrain = 4.0;     ///< white, rms
  double hum_microstrain = 0.5;       ///< amplitude
  double hum_Hz = 50.0;
  double drift_microstrain = 0.0;  ///< amplitude of a slow wander
  double drift_period_s = 20.0;
  double offset_microstrain =
      20.0;  ///< unbalance of the bridge; every other channel has the opposite one
  std::int32_t offset_codes = 0;  ///< the converter's own zero lies so many codes below
  std::uint64_t seed = 1;

  [[nodiscard]] double strain_per_code() const;
  [[nodiscard]] double volts_per_code() const;
  [[nodiscard]] double strain_per_V() const;
};

/// @throws InputError whose place is the setting
void check(const FrontEndSettings& settings);

/// Gaussian numbers of unit variance, a fixed one for each seed, channel and tick.
class NoiseStream {
 public:
  NoiseStream(std::uint64_t seed, std::size_t channel) : seed_(seed), channel_(channel) {}

  /// Adds factor times the numbers of first_tick, first_tick + 1, ...
  void add(Tick first_tick, double factor, std::span<double> values);

 private:
  static constexpr Tick kChunk = 256;
  void draw(Tick chunk);

  std::uint64_t seed_;
  std::uint64_t channel_;
  Tick drawn_ = -1;
  std::array<float, kChunk> numbers_{};
};

/// One channel of the front end.
class FrontEnd {
 public:
  FrontEnd(const FrontEndSettings& settings, std::size_t channel);

  /// Turns strains at first_tick, first_tick + 1, ... into codes. @pre strain.size() ==
  /// codes.size()
  void convert(Tick first_tick, SampleRate rate, std::span<double> strain,
               std::span<std::int32_t> codes);

 private:
  FrontEndSettings settings_;
  double offset_strain_;
  double hum_phase_;
  double drift_phase_;
  NoiseStream noise_;
};

}  // namespace kolsky

#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/separation/separation.hpp"
#include "processing/waves/wave_theory.hpp"

namespace kolsky {

/// How the waves in one bar of a shot are told apart.
struct RecordedWavesOptions {
  std::string bar = "input";
  std::vector<double> positions_m{};  ///< where the waves are wanted, from the bar's start; its two
                                      ///< ends where empty
  WaveTheory theory = WaveTheory::elementary;
  std::optional<double> band_limit_Hz{};  ///< else what noise and bar model allow
  bool gauges_only = false;               ///< nothing is taken for known of the bar's far end
  /// Of the input bar at a specimen: the output bar's force is taken for the force at its end.
  bool equilibrium = false;
  std::optional<Material> bar_model{};  ///< of a viscoelastic bar; else the shot's own
};

/// What the waves leave of a gauge's record.
struct GaugeLeft {
  std::string gauge;
  double left_rms = 0.0;   ///< of record less waves, from the pulse on, within the band [strain]
  double noise_rms = 0.0;  ///< of the record before the pulse, within the band [strain]
};

/// The bar at one place over the record's time.
struct WavesAtPlace {
  double position_m = 0.0;
  SeparatedWaves waves{};
  std::vector<double> stress_noise_Pa{};  ///< one standard deviation; zero where noise is unknown
};

/// One bar's right- and left-going waves (see WaveSeparation).
struct RecordedWaves {
  std::vector<std::string> gauges;
  bool end_known = false;  ///< what the far end returns, or the force at it, was used
  double band_limit_Hz = 0.0;
  std::size_t quiet = 0;  ///< samples before the first pulse: baselines and noise are theirs
  std::size_t known = 0;  ///< samples up to which the records tell the waves at all places
  std::vector<BlindFrequency> blind;
  std::vector<GaugeLeft> left;  ///< empty where there are no more gauges than it takes
  std::vector<WavesAtPlace> places;
};

/// Left- and right-going waves from all gauges of a bar, and from what its far end does where that
/// is known: free or matched as filed; at a specimen nothing, or the other bar's force.
/// @throws InputError where samples are missing or cut off, gauges do not suffice or none shows a
/// pulse, a place is off the bar, the band is beyond the record or what the gauges see, or
/// equilibrium is asked for without a specimen at the bar's end
[[nodiscard]] RecordedWaves recorded_waves(const Shot& shot, const RecordedWavesOptions& options);

}  // namespace kolsky

#pragma once

#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// A shot on a bar to be characterised, as strain at its gauges in the order of their positions.
struct BarRecords {
  std::vector<double> position_m;
  std::vector<std::vector<double>>
      strain;                        ///< compression positive, less the baseline before the pulse
  std::vector<double> noise_rms;     ///< of each gauge, before the pulse
  std::vector<double> step;          ///< of strain from code to code
  std::vector<double> rise_s;        ///< when the first pulse passes half of its peak
  std::vector<double> peak;          ///< of the first pulse
  std::vector<std::size_t> channel;  ///< each one's place in the bench's list of gauges
  std::size_t quiet_samples = 0;     ///< before the pulse
  double foot_s = 0.0;               ///< of the pulse at the first gauge, from the first sample
  double period_s = 0.0;
};

/// A channel's values in its gauge's unit.
[[nodiscard]] std::vector<double> readings_of(const ChannelRecord& channel);

/// @throws InputError where the shot cannot serve: another kind of bench, fewer than two gauges or
///   all at one place, a hole, clipped codes, no pulse, no quiet samples before it
[[nodiscard]] BarRecords read_bar_records(const Shot& shot);

}  // namespace kolsky

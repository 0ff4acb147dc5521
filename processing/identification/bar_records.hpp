#pragma once

#include <span>
#include <vector>

#include "processing/base/shot.hpp"

namespace kolsky {

/// A shot on a bar to be characterised, as strain at its gauges in the order of their positions.
struct BarRecords {
  std::vector<double> position_m;
  std::vector<std::vector<double>>
      strain;                     ///< compression positive, less the baseline before the pulse
  std::vector<double> noise_rms;  ///< of each gauge, before the pulse; at least that of its codes
  std::vector<double> step;       ///< of strain from code to code, the converter's
  std::vector<double> rise_s;     ///< when the first pulse passes half of its peak
  std::vector<double> peak;       ///< of the first pulse
  std::vector<bool> pulls;        ///< whether that is a tension
  std::vector<std::size_t> channel;  ///< each one's place in the bench's list of gauges
  std::size_t quiet_samples = 0;     ///< before the pulse
  double foot_s = 0.0;               ///< of the pulse at the first gauge, from the first sample
  double period_s = 0.0;
  bool returned = false;  ///< the second gauge is the first one when the far end answers, inverted
  double late_s = 0.0;    ///< how much later that one's record begins; its rise is not reckoned so

  /// A gauge's noise before the pulse.
  [[nodiscard]] std::span<const double> quiet(std::size_t gauge) const {
    return std::span<const double>(strain[returned ? 0 : gauge]).first(quiet_samples);
  }
  /// From the first gauge's rise to another one's, each in its own record.
  [[nodiscard]] double rise_behind_first_s(std::size_t gauge) const {
    return rise_s[gauge] - rise_s[0] - late_of_s(gauge);
  }
  /// Whether a gauge's quiet part stays at one code or two: its mean is known no better than a code
  /// then, however long it lasts, for what rounding makes of it averages out only over noise.
  [[nodiscard]] bool stays_at_a_code(std::size_t gauge) const {
    return noise_rms[gauge] < 0.5 * step[gauge];
  }
  [[nodiscard]] double late_of_s(std::size_t gauge) const { return gauge > 0 ? late_s : 0.0; }
};

/// A channel's values in its gauge's unit.
[[nodiscard]] std::vector<double> readings_of(const ChannelRecord& channel);

/// @throws InputError where the shot cannot serve: another kind of bench, several gauges all at
///   one place, a hole, clipped codes, no pulse, no quiet samples before it
[[nodiscard]] BarRecords read_bar_records(const Shot& shot);

}  // namespace kolsky

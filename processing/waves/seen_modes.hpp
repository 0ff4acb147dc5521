#pragma once

#include <span>
#include <vector>

#include "processing/waves/bar_modes.hpp"

namespace kolsky {

/// The longest that a wave in its band takes over a distance, in what a front takes over it: what
/// lateral inertia slows goes at half the front's speed and more, up to where gauges go blind.
[[nodiscard]] constexpr double slowest_over_front(WaveTheory theory) {
  return theory == WaveTheory::elementary ? 1.0 : 2.0;
}

/// As bar_modes, but bounded beyond what gauges see: from where groups would be slower than
/// slowest_over_front, or surface gauges are blind, waves are taken to go on as slowly, and to be
/// read, as they last were. A band's flank reaches there (Love's theory even to where waves stand
/// still) and leaves next to nothing, but next to nothing times what is beyond all bounds would be
/// all there is.
/// @param path  starts near zero
[[nodiscard]] std::vector<BarMode> seen_modes(WaveTheory theory, const Bar& bar,
                                              const Compliance& compliance,
                                              const std::vector<Complex>& path);

/// The highest band limit [Hz] for records of gauges that go blind at a frequency: the band's flank
/// has fallen to a hundredth there.
[[nodiscard]] double highest_band_limit_Hz(double blind_from_Hz);

}  // namespace kolsky

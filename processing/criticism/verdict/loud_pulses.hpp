#pragma once

#include <cstddef>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// How a gauge's readings of the pulses stand to its quiet parts.
struct LoudPulses {
  std::size_t gauge = 0;
  double power = 1.0;  ///< of the residuals over the noise of the quiet parts
  double log_p = 0.0;  ///< ln of the chance of as much at any gauge
};

/// How far the residuals of a fit stand above the noise of the quiet parts, along what an error of
/// each gauge's readings does to all of them, whether or not they come back from shot to shot: an
/// error of the model whose shape goes with the amplitude passes for noise otherwise. What slow
/// noise the quiet parts are too short to show, and what a coarse converter's steps leave of
/// records that move, counts as noise. Of two gauges an error of one looks like one of the other.
/// @param studied  fitted; what is known of the noise is what the quiet parts say afterwards
/// @return every gauge's, the reference's too, the least likely first
[[nodiscard]] std::vector<LoudPulses> loudness_of_pulses(Study& study, const Studied& studied);

/// By a fifth at least, and more than noise would in one of 1e5 campaigns.
[[nodiscard]] bool beyond_noise(const LoudPulses& pulses);

/// The first gauge, and all that stand half as far above their noise: an error of one shows in the
/// others' residuals as far as these are reckoned from it.
/// @param pulses  the least likely first
[[nodiscard]] std::vector<std::size_t> loudest(const std::vector<LoudPulses>& pulses);

}  // namespace kolsky

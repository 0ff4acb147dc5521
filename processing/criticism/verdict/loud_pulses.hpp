#pragma once

#include <optional>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// A gauge whose readings of the pulses hold more noise than its quiet parts do.
struct LoudPulses {
  std::size_t gauge = 0;
  double power = 1.0;  ///< over that of the quiet parts
  double log_p = 0.0;  ///< ln of the chance of as much at any gauge
};

/// The gauge at which the residuals of a fit stand furthest above the noise of the quiet parts,
/// whether or not they come back from shot to shot: an error of the model whose shape goes with the
/// amplitude passes for noise otherwise. What slow noise the quiet parts are too short to show, and
/// what a coarse converter's steps leave of records that move, counts as noise.
/// @param studied  fitted; what is known of the noise is what the quiet parts say afterwards
/// @return nothing where none stands above it by a fifth and more than noise would
[[nodiscard]] std::optional<LoudPulses> loud_pulses(Study& study, const Studied& studied);

}  // namespace kolsky

#pragma once

#include <vector>

#include "processing/models/effect.hpp"

namespace kolsky {

/// Smooth distortions that fit nearly anything and name nothing: at every gauge but the reference a
/// filter of powers of s, of slow relaxations and of echoes, and a gain that follows the shot's
/// amplitude. What they find in the residuals of a model is misfit that the model does not explain.
[[nodiscard]] const Effect& distortion_effect();
/// Of its strengths the first: a gain and what goes with the rate, a delay.
inline constexpr int kGainAndDelay = 2;

/// The same for amplitudes within a shot: every reading e becomes e (1 + b e + c e^2).
[[nodiscard]] const Effect& bent_scale_effect();

}  // namespace kolsky

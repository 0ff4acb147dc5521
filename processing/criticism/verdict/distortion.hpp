#pragma once

#include <numbers>
#include <vector>

#include "processing/models/effect.hpp"

namespace kolsky {

/// Smooth distortions that fit nearly anything and name nothing: at every gauge but the reference a
/// filter of powers of s, of slow relaxations and of echoes, and a gain that follows the shot's
/// amplitude. What they find in the residuals of a model is misfit that the model does not explain.
[[nodiscard]] const Effect& distortion_effect();
/// Of its strengths the first: a gain, and what goes with the rate in units of one over this.
inline constexpr int kGainAndRate = 2;
inline constexpr double kRateUnit_rad_per_s = 2.0 * std::numbers::pi * 1e4;

/// The same for amplitudes within a shot: every reading e becomes e (1 + b e + c e^2).
[[nodiscard]] const Effect& bent_scale_effect();

}  // namespace kolsky

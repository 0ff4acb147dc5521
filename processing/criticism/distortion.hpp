#pragma once

#include <vector>

#include "processing/models/effect.hpp"

namespace kolsky {

/// Smooth distortions that fit nearly anything and name nothing: at every gauge but the reference a
/// filter of powers of s, of slow relaxations and of echoes. What they find
/// in the residuals of a model is misfit that the model does not explain.
[[nodiscard]] const Effect& distortion_effect();

}  // namespace kolsky

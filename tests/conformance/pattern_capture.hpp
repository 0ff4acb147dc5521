#pragma once

#include "processing/base/shot.hpp"

namespace kolsky {

/// A shot of two gauges, g1 and g2, that carry the test pattern.
/// @param pattern_start  the pattern's tick at sample 0
[[nodiscard]] Shot pattern_shot(Tick pattern_start, std::size_t samples);

/// Declares samples missing, as they are stored: the last code before them repeated.
void make_gap(Shot& shot, Tick first_tick, Tick samples);

}  // namespace kolsky

#pragma once

#include <string>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Why no ball gives such a capture: it would pull, leave faster than it came, or push with an
/// impulse that is not between one and two times the momentum it came with. A speed in another
/// unit, a bridge's wrong factor and a wrong sign are found so. Empty: a ball may.
[[nodiscard]] std::string no_ball_does(const Shot& shot);

}  // namespace kolsky

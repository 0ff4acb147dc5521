#pragma once

#include <string>

#include "clients/figure/figure.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Measured contact force over time.
[[nodiscard]] Panel ball_force_panel(const BallImpact& ball);

/// The force and its running impulse on one page, with the low-pass, the speeds and the checks that
/// did not pass as notes. @pre the reduction is of a ball
[[nodiscard]] Figure ball_figure(const Reduction& reduction, const std::string& title);

}  // namespace kolsky

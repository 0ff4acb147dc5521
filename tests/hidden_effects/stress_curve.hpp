#pragma once

#include <vector>

#include "tests/generators/shpb_world.hpp"
#include "tests/hidden_effects/analyser.hpp"
#include "tests/hidden_effects/verdict.hpp"

namespace kolsky::scoring {

/// Stress that a specimen's material answers a constant strain rate with, step by step in time.
/// @param strain  where it is asked for, rising
/// @param loading_s  how long it takes to the last of them
[[nodiscard]] std::vector<double> true_stress_Pa(const testing::TrueSpecimen& specimen,
                                                 const std::vector<double>& strain,
                                                 double loading_s);

/// Adds how far the curve that `kolsky model waterfall` draws of its last model lies from the
/// specimen's own, in its stated deviations, at a third, two thirds and the end of the loading.
void judge_curve(Verdict& verdict, const Case& drawn, const Answer& waterfall);

}  // namespace kolsky::scoring

#pragma once

#include <vector>

namespace kolsky::testing {

/// Memory of one RC stage of time constant tau over a history at equal steps, exact while the input
/// runs linearly between samples.
[[nodiscard]] std::vector<double> one_pole(const std::vector<double>& input, double step_s,
                                           double tau_s);

/// A quarter bridge or an amplifier that bends: reading = e (1 + b e).
void bend(std::vector<double>& strain, double b);

}  // namespace kolsky::testing

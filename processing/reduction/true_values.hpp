#pragma once

#include <vector>

#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// True strain -ln(1 - e) and true stress s (1 - e) from engineering ones, compression positive,
/// for a specimen that keeps its volume. NaN where e >= 1.
[[nodiscard]] std::vector<double> true_strain(const Reduction& reduction);
[[nodiscard]] std::vector<double> true_stress_Pa(const Reduction& reduction);

}  // namespace kolsky

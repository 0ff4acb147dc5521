#pragma once

#include <vector>

#include "processing/criticism/composition.hpp"

namespace kolsky {

/// Two Kelvin elements in series may change names and no record changes. The material's own is the
/// one that yields more; a further relaxation is the lesser.
/// @param theta  of the composition, changed where the names were the other way round
/// @return whether they were
[[nodiscard]] bool put_branches_in_order(const Composition& composition,
                                         std::vector<double>& theta);

}  // namespace kolsky

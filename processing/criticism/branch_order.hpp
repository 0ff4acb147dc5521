#pragma once

#include <string>
#include <vector>

#include "processing/criticism/composition.hpp"

namespace kolsky {

/// Two Kelvin elements in series may change names and no record changes. The material's own is the
/// one that yields more; a further relaxation is the lesser.
/// @param theta  of the composition, changed where the names were the other way round
/// @return whether they were
[[nodiscard]] bool put_branches_in_order(const Composition& composition,
                                         std::vector<double>& theta);

/// The relaxation time of the material's own branch that this further one stands beside; 0 where
/// there is none, or the effect is no further relaxation.
[[nodiscard]] double own_branch_s(const Model& model, const std::string& further);

}  // namespace kolsky

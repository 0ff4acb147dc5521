#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/fitting/composition.hpp"

namespace kolsky {

/// Two Kelvin elements in series may change names and no record changes. The material's own is the
/// one that yields more; a further relaxation is the lesser.
/// @param theta  of the composition, changed where the names were the other way round
/// @return whether they were
[[nodiscard]] bool put_branches_in_order(const Composition& composition,
                                         std::vector<double>& theta);

/// The material's own branch that a further one stands beside.
struct OwnBranch {
  double time_s = 0.0;         ///< 0: there is none
  bool strength_known = true;  ///< to better than itself
};

/// @param further  id of an effect that may be a further relaxation
[[nodiscard]] OwnBranch own_branch(const Model& model, const std::string& further);

/// Where a further relaxation yields more than a third of what the material's own branch does:
/// which of them is called which is a convention, in a sentence. Else nothing.
[[nodiscard]] std::optional<std::string> either_branch_text(const Model& model,
                                                            const std::string& further);

}  // namespace kolsky

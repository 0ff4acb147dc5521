#pragma once

#include "processing/specimen/specimen_search.hpp"

namespace kolsky {

/// A set of assumptions with a number more replaces a simpler one when it takes this much more off
/// chi2: odds of 150 to 1.
constexpr double kWorthwhile = 10.0;

/// The best solid of a family that holds three elements within it, searched from where those are
/// at their best: from there itself, where what the family has more is nothing, and from a little
/// away to each side. By the weights of the noise that three elements foretell, so that it cannot
/// end worse than they do; by its own where it is worth more than they are.
/// @param three_element  under the same theory, of the same records
/// @throws InputError where no search converges
[[nodiscard]] SpecimenMinimum search_family(SpecimenLikelihood& likelihood, SolidKind solid,
                                            const ShpbTheory& theory,
                                            const SpecimenMinimum& three_element);

}  // namespace kolsky

#pragma once

#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// For each effect that a diagnosis leaves tied: the change of the experiment that would tell it
/// from its rivals best.
///
/// Every change that can be reckoned with is made to the shots in hand: their waves go through the
/// model with the effect in it, on the changed bench, with the noise they have. First order ranks
/// the changes by how far the effect's strength would stand out with the nearest rival free beside
/// it; of those that come first the rivals are fitted in the effect's place, and what counts is by
/// how much they fit worse (what is tied may differ by second order only). Where even the best
/// change leaves them apart by too little, so many shots more are asked for as would do; where that
/// is too many, exchanged channels are, which no model of the bench foretells.
/// @param study      as the diagnosis left it
/// @param diagnosis  of a bar or a split bar, with its model
[[nodiscard]] std::vector<NextExperiment> next_experiments(Study& study,
                                                           const Diagnosis& diagnosis);

}  // namespace kolsky

#pragma once

#include <functional>

#include "processing/criticism/fitting/composition.hpp"

namespace kolsky {

/// A model with its free auxiliary parameters (relaxation times, harmonics, which neighbour) at the
/// best of their starts, and strengths that nothing of first order at null speaks for (a length,
/// which acts by its square) at the best of null and some multiples of their typical size. What is
/// chosen among a few is held from then on; what is free to move is left alone where its effect has
/// a strength already.
/// @param objective  of a fit that begins there, less is better; told whether it is the first that
///                   counts of a parameter
[[nodiscard]] Model at_best_starts(
    Model model, const Campaign& campaign,
    const std::function<double(const Composition&, bool first)>& objective);

}  // namespace kolsky

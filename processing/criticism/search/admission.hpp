#pragma once

#include "processing/criticism/search/refit.hpp"
#include "processing/criticism/search/search_ground.hpp"
#include "processing/criticism/search/slow_chances.hpp"

namespace kolsky {

/// What fits better for counting more as noise fits nothing: where a gauge sees hardly a signal,
/// its factor runs away, and the noise carried to it is all that is compared.
[[nodiscard]] bool fits_the_signal(const Refit& refit, const Studied& base);

/// Whether a refit is an explanation at all: it fits the signal, by a strength that stands out and
/// that its formula allows, and is no limit of another effect.
[[nodiscard]] bool explains(const Refit& refit, const SearchGround& ground);

/// Confirms strengths that every shot has of its own: by their products, or by what slow noise does
/// not do, whose chance is put into the refit. @return whether they are more than chance; of
///   effects that have none, true
[[nodiscard]] bool confirm_own_strengths(Refit& refit, const SearchGround& ground,
                                         SlowChances& slow);

}  // namespace kolsky

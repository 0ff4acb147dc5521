#pragma once

#include <string>
#include <vector>

#include "processing/models/model.hpp"

namespace kolsky {

/// Models that hold, each, something that laboratories meet and no effect of the library is:
///
///     reading x (1 + c / (1 + s tau))   of one gauge: a bond that creeps, an amplifier that droops
///     reading = e (1 + c e^2)           of one gauge or of all: an amplifier that runs out of
///     range
///
/// What they explain is told, and never claimed.
[[nodiscard]] std::vector<Model> with_unlisted(const Model& model, const Bench& bench);

/// Which of them it is, and of which gauge. @param fitted  one of `with_unlisted`
[[nodiscard]] std::string unlisted_id(const Model& fitted);

/// What such a fit says, and the formula by which to add it.
/// @param fitted   likewise
/// @param as_much  it explains as much as two effects and more do, not nearly all that is unknown
[[nodiscard]] std::string unlisted_text(const Model& fitted, bool as_much);

}  // namespace kolsky

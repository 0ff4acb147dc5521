#pragma once

#include <optional>
#include <string>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Whether a specimen that is pushed and never pulled explains most of what a split bar's model
/// leaves, and more by far than what the library has for it: glued faces are the model's, loose
/// ones every laboratory's, and what returning waves do to these is no small change of anything
/// else.
/// @param base     the model, fitted, of which it is asked
/// @param start    the model as the search began with it
/// @param nearest  what the library's best leaves; without any, that of the model itself
/// @return what it does and how to add it; nothing where it does not
[[nodiscard]] std::optional<std::string> parting_in_place_of(Study& study, const Studied& base,
                                                             const Model& start,
                                                             const Studied& nearest);

}  // namespace kolsky

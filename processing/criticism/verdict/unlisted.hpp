#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// What an unlisted thing is held against: what is claimed, or all that is missing where what was
/// found is not believed or nothing was.
enum class InPlaceOf { claims, all };

/// What laboratories meet and no effect of the library is (`unlisted_effects.hpp`): one gauge's
/// reading that creeps, droops, bends or changes from a time on, and readings of all that bend.
///
/// It is never claimed. One such thing is likelier than two effects which do no better, and worth
/// being told of where it leaves next to nothing of what is unknown. Of two gauges a bar's own
/// effects do as well.
/// @param before   without what is claimed
/// @param current  with it
/// @param effects  that are claimed, but for those which every bar has
/// @return what it does and the formula by which to add it; nothing where it does not
[[nodiscard]] std::optional<std::string> unlisted_in_place_of(Study& study, const Studied& before,
                                                              const Studied& current,
                                                              std::size_t effects, InPlaceOf what);

}  // namespace kolsky

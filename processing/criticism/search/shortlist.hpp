#pragma once

#include <cstddef>
#include <vector>

#include "processing/criticism/search/search_ground.hpp"
#include "processing/criticism/search/slow_chances.hpp"

namespace kolsky {

/// The candidates worth a refit, each once: the best variant of every effect that is near the best
/// of all, and what first order cannot tell from these.
/// @param slow  of the same ground; null: nobody asks what slow noise does
[[nodiscard]] std::vector<std::size_t> worth_refitting(const SearchGround& ground,
                                                       SlowChances* slow);

}  // namespace kolsky

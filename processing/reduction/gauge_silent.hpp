#pragma once

#include <optional>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// A check that fails, "gauge_silent", where the first pulse is at one gauge of a pair, or of more
/// at one place, less than three tenths of what it is at another that has it far out of its noise:
/// bending does not do that, and their mean would have half of the wave. Nothing where none does.
/// Reads every record anew: for reductions that something is wrong with.
[[nodiscard]] std::optional<Check> gauge_silent(const Shot& shot);

}  // namespace kolsky

#pragma once

#include <optional>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// A check that fails, "gauge_silent", where a gauge reads less than three tenths of the most that
/// another of the same bar reads: no bar takes so much of a wave between them, and the mean of a
/// pair would have half of it. Nothing where none does. Reads every record anew: for reductions
/// that something is wrong with.
[[nodiscard]] std::optional<Check> gauge_silent(const Shot& shot);

}  // namespace kolsky

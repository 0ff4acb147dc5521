#pragma once

#include <optional>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Whether a reduction looks as if a channel, or every one, read with the other sign: the incident
/// pulse is not what the bench's bars are loaded by, or the faces' forces go against each other,
/// which they cannot.
[[nodiscard]] bool signs_in_doubt(const Shot& shot, const Reduction& reduction);

/// A check, "gauge_sign": fails where the first pulse is a tension at some gauges and a compression
/// at others, which no specimen makes of it, and names those that are not what the bars are loaded
/// by; warns where all are not. Nothing where all are. Reads every record anew: for reductions that
/// something is wrong with.
[[nodiscard]] std::optional<Check> gauge_sign(const Shot& shot);

}  // namespace kolsky

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Whether a reduction looks as if a channel, or every one, read with the other sign: the incident
/// pulse is not what the bench's bars are loaded by, or the faces' forces go against each other,
/// which they cannot.
[[nodiscard]] bool signs_in_doubt(const Shot& shot, const Reduction& reduction);

/// What the first pulse of a record is; nothing where none is seen.
/// @param strain  compression positive
[[nodiscard]] std::optional<PositiveSense> first_sense(const std::vector<double>& strain,
                                                       double sample_rate_Hz);

/// What is said of gauges whose first pulse is not what the bars are loaded by, as it is at others.
/// @param on_input  whether one of them is on the input bar
[[nodiscard]] std::string other_sign_text(const std::vector<std::string>& gauges,
                                          PositiveSense loading, bool on_input);

/// A check, "gauge_sign": fails where the first pulse is a tension at some gauges and a compression
/// at others, which no specimen makes of it, and names those that are not what the bars are loaded
/// by; warns where all are not. Nothing where all are. Reads every record anew: for reductions that
/// something is wrong with.
[[nodiscard]] std::optional<Check> gauge_sign(const Shot& shot);

}  // namespace kolsky

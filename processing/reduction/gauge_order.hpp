#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// So much later is later [samples]: noise and a delay of one do not make it up.
inline constexpr double kClearlyLater = 3.0;

/// Strain of one gauge, less what it read before its first pulse; empty where none is seen.
[[nodiscard]] std::vector<double> strain_of_gauge(const Shot& shot, std::size_t gauge);

/// A bench's gauges as a pulse from the struck end comes to them.
[[nodiscard]] std::vector<std::size_t> in_filed_order(const Bench& bench);

/// How much later a pulse comes to one gauge than to another [samples]: when one height is passed
/// at both, so that a wave that comes back soon, and lowers the top of one gauge's pulse, changes
/// no order.
/// @param gauge  strain, as long as `than`
/// @return nothing where it is not seen at both
[[nodiscard]] std::optional<double> later_by(std::span<const double> gauge,
                                             std::span<const double> than, double rate_Hz);

/// What two gauges say against the bench in whose other order a pulse comes to them, in one line:
/// cables, columns or places that were exchanged.
/// @param how_much  "12 us"
[[nodiscard]] std::string exchanged_text(const Gauge& first, const Gauge& second,
                                         const std::string& how_much);

/// A check that fails, "gauge_order", where the pulse comes to neighbouring gauges in the other
/// order than the filed one; nothing where it does not. Reads every record anew: for reductions
/// that something is wrong with.
[[nodiscard]] std::optional<Check> gauge_order(const Shot& shot);

}  // namespace kolsky

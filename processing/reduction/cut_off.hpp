#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace kolsky {

/// Where a record stays at its highest or lowest value because it was cut off there.
struct CutOff {
  std::size_t first = 0;  ///< sample
  std::size_t count = 0;  ///< samples in a row
};

/// A record that stays at one of its extremes far longer than it stays anywhere else near it has
/// been cut off there, wherever its codes end: a table does not tell the converter's range. Both
/// extremes are looked at, as they lie from where the record begins: a bridge's offset decides
/// which reading is the larger, and not which end of the converter a pulse comes to.
/// @return nothing where it was not, the longer stretch where it was at both ends
[[nodiscard]] std::optional<CutOff> cut_off(std::span<const double> readings);

}  // namespace kolsky

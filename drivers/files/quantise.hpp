#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace kolsky {

/// Values as 32-bit codes, value = code * scale.
struct QuantisedValues {
  double scale = 1.0;  ///< a power of two
  std::vector<std::int32_t> codes;
};

/// The finest power of two that keeps every code inside (INT32_MIN, INT32_MAX), so that nothing
/// looks clipped: rounding stays below 5e-10 of the largest magnitude. @pre all values are finite
[[nodiscard]] QuantisedValues quantise(std::span<const double> values);

}  // namespace kolsky

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

/// The finest power of two that keeps every code, and that of `full_scale`, inside (INT32_MIN,
/// INT32_MAX), so that nothing looks clipped: rounding stays below 5e-10 of the largest magnitude.
/// Records whose values all stay below the same full scale have the same scale.
/// @pre all values are finite, full_scale >= 0
[[nodiscard]] QuantisedValues quantise(std::span<const double> values, double full_scale = 0.0);

}  // namespace kolsky

#pragma once

#include <array>
#include <string>

namespace kolsky {

/// Exponents of kg, m, s, K and A in a quantity's unit.
struct Dimension {
  std::array<double, 5> of{};

  [[nodiscard]] bool none() const;
  [[nodiscard]] bool same(const Dimension& other) const;
  [[nodiscard]] Dimension times(const Dimension& other, double power) const;
  /// "kg/(m s2)" in words that a person checks a formula with; "no unit" for a pure number.
  [[nodiscard]] std::string text() const;
};

/// The dimension of a coherent SI unit: "1/(Pa s)", "m2/s", "Hz"; "-", "1", "strain" and "rad" have
/// none. Prefixes are refused: all numbers of a model are in SI.
/// @throws InputError whose place is the unit
[[nodiscard]] Dimension dimension_of(const std::string& unit);

}  // namespace kolsky

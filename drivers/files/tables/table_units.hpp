#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace kolsky {

/// What a column's values are, and the factor that makes them volts or strain.
struct ColumnUnit {
  enum class Quantity { volts, strain };
  Quantity quantity = Quantity::volts;
  double factor = 1.0;
  friend bool operator==(const ColumnUnit&, const ColumnUnit&) = default;
};

/// "mV", "με", "microstrain", ...; none for anything else.
[[nodiscard]] std::optional<ColumnUnit> column_unit(std::string_view text);

/// Seconds per "s", "ms", "us", "µs", "ns"; none for anything else.
[[nodiscard]] std::optional<double> time_unit_s(std::string_view text);

/// A name with the unit that may stand behind it: "g1", "g1 (mV)", "g1 [mV]", "g1/mV", "g1_mV".
struct NameAndUnit {
  std::string_view name;
  std::string_view unit;   ///< empty if there is none
  bool bracketed = false;  ///< so that it can be nothing but a unit
};
[[nodiscard]] NameAndUnit split_unit(std::string_view header);

/// The text inside a pair of brackets, "(mV)" or "[mV]", or the text itself.
[[nodiscard]] std::string_view without_brackets(std::string_view text);

}  // namespace kolsky

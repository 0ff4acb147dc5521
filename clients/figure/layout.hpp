#pragma once

#include <string>
#include <vector>

#include "clients/figure/figure.hpp"

namespace kolsky {

struct AxisRange {
  double low = 0.0;
  double high = 1.0;

  /// Where a value lies: 0 at `low`, 1 at `high`.
  [[nodiscard]] double fraction(double value) const { return (value - low) / (high - low); }
};

/// The unit that people read: what to multiply by, and its name ("MPa", "us" as "µs", "%").
struct DisplayUnit {
  double factor = 1.0;
  std::string name;
};

/// @param unit     of the data, SI
/// @param largest  the largest magnitude that is shown
[[nodiscard]] DisplayUnit display_unit(const std::string& unit, double largest);

/// A number and its unit for people, three or four digits: "31.4 MPa".
[[nodiscard]] std::string with_unit(double value, const std::string& unit);

/// A number and its deviation in one unit, to the deviation's second digit: "31.42 ± 0.17 MPa".
[[nodiscard]] std::string with_deviation(double value, double sd, const std::string& unit);

/// A mark on an axis: where (in the data's unit) and what is written there (in the display unit).
struct AxisMark {
  double at = 0.0;
  std::string label;
};

/// An axis ready to draw.
struct AxisLayout {
  AxisRange range;
  std::vector<AxisMark>
      marks;          ///< at 1, 2 or 5 times a power of ten of the display unit, all inside `range`
  std::string title;  ///< "stress [MPa]"
};

/// @param most_marks  at most so many marks, at least two are aimed at
[[nodiscard]] AxisLayout lay_out(const Axis& axis, AxisRange range, int most_marks);

/// What the finite points of a panel span; never empty: a flat span is widened, no point at all
/// gives 0 to 1.
/// Zero is taken in where it is near.
[[nodiscard]] AxisRange x_range(const Panel& panel);
[[nodiscard]] AxisRange y_range(const Panel& panel);

}  // namespace kolsky

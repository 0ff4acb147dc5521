#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace kolsky {

/// What stands between the columns of a table: tab, ';' or ',', or ' ' for any run of blanks. With
/// anything but ',' a comma inside a number is a decimal comma.
using Separator = char;

/// Splits a line into cells without the blanks and quotes round them. Separators inside quotes
/// count as text. The views point into the line.
void split_cells(std::string_view line, Separator separator, std::vector<std::string_view>& cells);

/// The number a cell holds (finite or not), or none if it holds anything else.
[[nodiscard]] std::optional<double> cell_number(std::string_view cell, Separator separator);

/// The text without blanks at its ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// ASCII letters in lower case, the rest as it is.
[[nodiscard]] std::string lower_case(std::string_view text);

}  // namespace kolsky

#pragma once

#include <string>

namespace kolsky {

/// A finite number as TOML has it; reads back as the same bits.
[[nodiscard]] std::string toml_number(double value);

/// A text as TOML has it, in quotes.
[[nodiscard]] std::string toml_quoted(const std::string& text);

/// A text of many lines as TOML has it, each on a line of its own.
[[nodiscard]] std::string toml_lines(const std::string& text);

}  // namespace kolsky

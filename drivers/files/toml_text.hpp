#pragma once

#include <string>

namespace kolsky {

/// A number as TOML has it, read back as the same bits. @pre finite
[[nodiscard]] std::string toml_number(double value);

/// A text in quotes, with what TOML takes for something else written out.
[[nodiscard]] std::string toml_quoted(const std::string& text);

}  // namespace kolsky

#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace kolsky {

/// Columns that a UTF-8 text takes, escape sequences not counted. Every character is taken as one
/// column wide.
[[nodiscard]] std::size_t columns_of(std::string_view text);

/// The words of a text in lines of at most so many columns; a longer word has a line of its own.
[[nodiscard]] std::vector<std::string> wrapped(const std::string& text, std::size_t columns);

}  // namespace kolsky

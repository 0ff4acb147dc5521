#pragma once

#include <cstddef>
#include <string_view>

namespace kolsky {

/// Length of the longest prefix that is well-formed UTF-8 (no surrogates, no overlong forms);
/// text.size() if all of it is.
[[nodiscard]] std::size_t valid_utf8_prefix(std::string_view text) noexcept;

}  // namespace kolsky

#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace kolsky {

/// Number of single-character insertions, deletions, replacements and swaps of neighbours that turn
/// one word into the other (optimal string alignment).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// The name with the smallest distance, the first of equals; a word that a name begins with is one
/// edit from it. Empty if there are none.
[[nodiscard]] std::string nearest_name(std::string_view word,
                                       const std::vector<std::string>& names);

}  // namespace kolsky

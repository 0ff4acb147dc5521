#pragma once

#include <map>
#include <string>

namespace kolsky {

/// Checks what travels with a shot as its `meta`: names and lines of text, and where the name ends
/// in a unit (`_K`, `_m_per_s`) a number in the range that such a quantity has.
/// @throws InputError
void check_shot_facts(const std::map<std::string, std::string>& meta);

}  // namespace kolsky

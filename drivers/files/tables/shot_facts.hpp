#pragma once

#include <map>
#include <string>

namespace kolsky {

/// Checks what travels with a shot as its `meta`: names and lines of text, and where the name ends
/// in a unit (`_K`, `_m_per_s`) a number in the range that such a quantity has, `_sd` behind it a
/// deviation. What came to the bar came with a speed above 0. Names are free, but none may be
/// nearly one that programs read (`incident_speed` for `incident_speed_m_per_s`).
/// @throws InputError
void check_shot_facts(const std::map<std::string, std::string>& meta);

}  // namespace kolsky

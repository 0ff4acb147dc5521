#pragma once

#include <string>

namespace kolsky {

/// How waves travel in a bar: one-dimensionally (the paper), with lateral inertia to first order
/// (Love), or exactly (Pochhammer and Chree, first mode).
enum class WaveTheory { elementary, love, exact };

/// @throws InputError for any other name
[[nodiscard]] WaveTheory wave_theory(const std::string& name);
[[nodiscard]] std::string name_of(WaveTheory theory);

}  // namespace kolsky

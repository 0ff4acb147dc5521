#pragma once

#include <cstddef>
#include <string>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Why a shot's records are not those of its strain, in one line: what is `unusable_because`, a
/// gauge's record that was cut off, or one that begins within its pulse. Empty where they may be.
/// All that fits a model to records asks it first.
[[nodiscard]] std::string spoiled_because(const Shot& shot);

/// What to do about a record that begins within its pulse.
inline constexpr const char* kRecordFromBefore =
    "trigger earlier, or record for longer before the trigger";

/// @param samples  before the pulse, fewer than kFewestQuiet
[[nodiscard]] std::string too_few_quiet(std::size_t samples);

}  // namespace kolsky

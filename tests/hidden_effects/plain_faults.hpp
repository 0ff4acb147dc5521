#pragma once

#include <string>
#include <vector>

#include "tests/hidden_effects/verdict.hpp"

namespace kolsky::scoring {

/// From this multiple of its smallest identifiable size on a single effect is clear: chance takes
/// it from no analyser, 24 deviations as it stands.
inline constexpr double kClear = 4.0;

/// What no chance excuses, so that a few cases can show it: something claimed where nothing is
/// hidden or what is hidden is withheld, something else named in a single effect's place, a clear
/// one not in any set, a case that failed or ran out of time. One line each; empty where all is
/// well.
[[nodiscard]] std::vector<std::string> plain_faults(const std::vector<Verdict>& verdicts);

}  // namespace kolsky::scoring

#pragma once

#include <string>

namespace kolsky {

/// What becomes of a candidate.
enum class CandidateVerdict {
  named,        ///< claimed, and told from all others
  tied,         ///< claimed, or as good as what is
  rejected,     ///< refitted: not foretold, shots disagree, or it imitates something
  unconfirmed,  ///< only strengths of single shots gain, and nothing else shows them
  not_needed,   ///< noise gains as much, or others explain it
  untestable,   ///< no strength within its bounds shows here
};

/// "named", "tied", "rejected", "unconfirmed", "not needed", "untestable"
[[nodiscard]] std::string name_of(CandidateVerdict verdict);

}  // namespace kolsky

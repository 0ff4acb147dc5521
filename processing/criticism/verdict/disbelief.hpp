#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// Anything can be expanded in three effects: that one is missing which the library does not have
/// is likelier than that three are at once.
inline constexpr std::size_t kMostBelieved = 2;

/// Whether an effect is so strong that nothing is built so: then noise was fitted with it.
/// @param slack  while effects beside it are still missing, it stands for a part of these, too
[[nodiscard]] bool beyond_belief(const Studied& studied, const std::string& id,
                                 const Campaign& campaign, double slack);

/// Why what was claimed is not what is missing, in sentences; empty: it may be.
/// @param current  fitted with what was claimed
/// @param remains  misfit that nothing explains
[[nodiscard]] std::vector<std::string> why_unknown(const Diagnosis& diagnosis,
                                                   const Studied& current, const Campaign& campaign,
                                                   bool remains);

}  // namespace kolsky

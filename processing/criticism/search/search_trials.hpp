#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

/// Of the generator that the simulated repeats are drawn from.
inline constexpr std::uint64_t kSearchSeed = 20260101;

/// How many independent tests a search among candidates amounts to, at a chance of 5 % for the best
/// of all, from simulated repeats of pure noise: the candidates' directions overlap.
/// @param which  of them are searched
[[nodiscard]] double independent_trials(const Studied& studied,
                                        const std::vector<Candidate>& candidates,
                                        const std::vector<Direction>& directions,
                                        std::span<const std::size_t> which);
/// The same of all of them.
[[nodiscard]] double independent_trials(const Studied& studied,
                                        const std::vector<Candidate>& candidates,
                                        const std::vector<Direction>& directions);

}  // namespace kolsky

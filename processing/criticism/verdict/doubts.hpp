#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "processing/criticism/verdict/at_bounds.hpp"
#include "processing/criticism/verdict/findings.hpp"
#include "processing/criticism/verdict/unexplained.hpp"

namespace kolsky {

/// What one certified effect may leave, of a misfit that it explains.
inline constexpr double kAllowedRest = 0.01;
/// The same of so many: together they fit what is not in the library better than one does, so less
/// may remain.
[[nodiscard]] double allowed_rest(std::size_t effects);

/// Whether more than noise is left, in units of what the quiet part shows of it: noise may be
/// somewhat beyond that.
[[nodiscard]] bool beyond_quiet(const HeldOut& misfit);

/// Numbers of what is claimed that stand at the end of what they may be.
[[nodiscard]] std::vector<AtBound> claimed_at_bounds(const Findings& found);

/// Why what was found is not what is missing, in sentences, by the noise that it was found with;
/// empty: it may be.
/// @param before   without what was found, in the same noise
/// @param remains  misfit that nothing explains, where there is any
/// @param noise    what the objective has of it per residual
[[nodiscard]] std::vector<std::string> doubts(Study& study, const DiagnosisOptions& options,
                                              const Findings& found, const Studied& before,
                                              const std::optional<Unexplained>& remains,
                                              double noise);

}  // namespace kolsky

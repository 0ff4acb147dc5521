#pragma once

#include <optional>

#include "processing/criticism/verdict/findings.hpp"

namespace kolsky {

/// What is left where nothing is named.
struct LeftOver {
  double excess = 0.0;  ///< chi2 beyond what noise leaves
  /// It is in all shots and gauges alike: what each has of its own says nothing of what the search
  /// began with.
  bool in_common = false;
};

/// Settles what is claimed, or gives it up where what is left or anything else speaks against it,
/// and puts down in the diagnosis what was found, how well and what limits it.
/// @return nothing where it is not given up
[[nodiscard]] std::optional<LeftOver> conclude(Study& study, const DiagnosisOptions& options,
                                               Findings& found);

}  // namespace kolsky

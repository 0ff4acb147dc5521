#pragma once

#include "processing/criticism/impact/impact_findings.hpp"

namespace kolsky {

/// What is said of what was found: named, tied, or let go of again where something speaks against
/// it; with misfits, the next experiment and what limits it all.
[[nodiscard]] Diagnosis conclude(ImpactStudy& study, const ImpactFindings& found,
                                 const DiagnosisOptions& options);

}  // namespace kolsky

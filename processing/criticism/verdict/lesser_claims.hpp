#pragma once

#include "processing/criticism/verdict/findings.hpp"

namespace kolsky {

/// Takes back what is claimed beside something that does as well alone, or that leaves it: a third
/// that is dwarfed by two, what a law's formula leaves, drifts beside a hum in unequal shares.
/// Strengths that every gauge has of its own become one for all where that does as well.
void set_lesser_claims_aside(Study& study, const DiagnosisOptions& options, Findings& found);

}  // namespace kolsky

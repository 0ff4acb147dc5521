#pragma once

#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/findings.hpp"

namespace kolsky {

/// The model goes on with what was chosen, and in the noise as it shows then.
void go_on_with(Study& study, const DiagnosisOptions& options, Choice& choice, Findings& found);

/// Looks again at what was found first: what others have made superfluous goes, and the rest is
/// sought again beside all others, as its rivals may do better there.
void go_back(Study& study, const DiagnosisOptions& options, Findings& found);

}  // namespace kolsky

#pragma once

#include <string>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Where a fit has led what no effect claims (materials, densities, diameters), against what is
/// filed of it.
struct FiledConflict {
  double log_p = 0.0;       ///< ln of the chance that true numbers lie so far from what is filed
  std::string furthest;     ///< "three-element-core E2_Pa"
  double deviations = 0.0;  ///< of the furthest, filed ones
};

/// With a true model a fit leads what is filed no further than its deviations say, the
/// calculation's error being among what the fit counts: another code's mesh moves the materials
/// little (docs/impact.md). A number that took up what the model lacks lies further off.
[[nodiscard]] FiledConflict conflict_with_filed(const Studied& studied);

/// Of bars, in a sentence.
[[nodiscard]] std::string filed_text(const FiledConflict& conflict);

/// Of impacts, whose materials take up much. @param claims  something is certified
[[nodiscard]] std::string filed_note(const FiledConflict& conflict, bool claims);

}  // namespace kolsky

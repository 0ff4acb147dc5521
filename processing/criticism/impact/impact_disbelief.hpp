#pragma once

#include <string>
#include <vector>

#include "processing/criticism/impact/impact_findings.hpp"

namespace kolsky {

/// What speaks against what was found, or against a model in which nothing is missing.
struct ImpactDisbelief {
  std::vector<std::string> reasons;  ///< in sentences
  bool gives_up = false;             ///< nothing is named, and the model is not adequate
  /// What a ball lacks may have gone into the law's form, as far as that goes, or into materials: a
  /// model without a claim is not known to be adequate.
  bool taken_up = false;
};

/// @param held_out   misfit of speeds that the fits did not see
/// @param log_alpha  ln of the chance of a false claim
[[nodiscard]] ImpactDisbelief disbelief_in(const ImpactFindings& found, const HeldOut& held_out,
                                           double log_alpha, ImpactStudy& study);

/// Whether nothing will be said of what is missing, whatever a few more steps make of the fit: they
/// have moved such logarithms of chances by a thirtieth.
[[nodiscard]] bool surely_disbelieved(const ImpactFindings& found, double log_alpha,
                                      const ImpactStudy& study);

}  // namespace kolsky

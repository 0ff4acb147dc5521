#pragma once

#include "processing/criticism/impact/impact_study.hpp"
#include "processing/criticism/verdict/diagnosis.hpp"

namespace kolsky {

/// The model as fitted beside the impacts, and with what was found, under the noise and the
/// allowance for the calculation that the verdict stands on.
struct ImpactsSeen {
  ImpactComparison before;
  ImpactComparison after;
};

/// Finds what a model of impacts lacks, as diagnose() does for bars, with two differences. What the
/// solver itself may be off by (mesh, contact, finite-strain law) is never claimed as an effect: it
/// is part of the residuals' covariance or a known unknown. And certified is only what foretells
/// shots and speeds that the fit did not see, with one strength at all speeds. The readings of the
/// law in three dimensions are rivals of whatever is found.
/// @param seen  what was compared on the way, if given
[[nodiscard]] Diagnosis diagnose_impacts(ImpactStudy& study, const Model& model,
                                         const DiagnosisOptions& options,
                                         ImpactsSeen* seen = nullptr);

}  // namespace kolsky

#include "processing/criticism/impact/impact_diagnosis.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "processing/criticism/impact/impact_conclusion.hpp"
#include "processing/criticism/impact/impact_disbelief.hpp"
#include "processing/criticism/impact/impact_findings.hpp"
#include "processing/criticism/impact/impact_notes.hpp"
#include "processing/criticism/records/arrival_order.hpp"

namespace kolsky {

namespace {

/// What is said with a number needs the fit at its end.
void fit_to_its_end(ImpactStudy& study, ImpactFindings& found, const DiagnosisOptions& options) {
  if (found.settled == Settle::fully || surely_disbelieved(found, options.log_alpha, study)) {
    return;
  }
  options.progress("fitting what is said to its end");
  found.current = study.polished(found.current);
}

/// The first model with the forces that it was fitted with, which are at hand.
ImpactComparison compared_at_first(ImpactStudy& study, const ImpactFindings& found) {
  study.residuals().anchor(found.first.composition, found.first_anchor);
  return study.compare(found.first);
}

}  // namespace

Diagnosis diagnose_impacts(ImpactStudy& study, const Model& model, const DiagnosisOptions& options,
                           ImpactsSeen* seen) {
  ImpactFindings found = find_what_impacts_lack(study, model, options);
  fit_to_its_end(study, found, options);
  Diagnosis diagnosis = conclude(study, found, options);
  const std::vector<std::string> misfiled = misfiled_gauges(study.campaign());
  diagnosis.notes.insert(diagnosis.notes.begin(), misfiled.begin(), misfiled.end());
  ImpactComparison after = study.compare(found.current);
  std::ranges::move(restitution_notes(after), std::back_inserter(diagnosis.notes));
  if (seen != nullptr) {
    seen->before = diagnosis.effects.empty() ? after : compared_at_first(study, found);
    seen->after = std::move(after);
  }
  return diagnosis;
}

}  // namespace kolsky

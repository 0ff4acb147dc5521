#include "processing/criticism/impact/impact_conclusion.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include "processing/criticism/impact/impact_certifier.hpp"
#include "processing/criticism/impact/impact_disbelief.hpp"
#include "processing/criticism/impact/impact_notes.hpp"
#include "processing/criticism/impact/next_impact.hpp"
#include "processing/criticism/impact/rival_materials.hpp"
#include "processing/criticism/verdict/claims.hpp"

namespace kolsky {

namespace {

HeldOut held_out_of(ImpactStudy& study, const ImpactFindings& found, double log_alpha) {
  const ImpactCertifier certifier(study, log_alpha);
  const ImpactResiduals& residuals = study.residuals();
  // Noise alone leaves what arrivals and offsets do not take up.
  const double left = 1.0 - residuals.eliminated() / static_cast<double>(residuals.per_shot());
  return {certifier.held_out_misfit(found.first), certifier.held_out_misfit(found.current), left};
}

/// Where one effect is claimed and leaves what stands out, the others of the materials are fitted
/// to their ends as well: one that explains more overrules it.
std::optional<std::string> better_than_claimed(ImpactStudy& study, const ImpactFindings& found,
                                               const DiagnosisOptions& options) {
  const std::vector<std::string>& claimed = found.diagnosis.effects;
  if (claimed.size() != 1 || study.allowance(found.current) == Allowance::kept) {
    return std::nullopt;
  }
  return better_of_materials(study, found.first.model, found.current, claimed.front(),
                             options.progress);
}

std::string overruled_note(const std::string& better, const std::string& claimed) {
  return fmt::format(
      "{} explains more than {} does, fitted to its end: nothing is claimed; `kolsky model "
      "add` it, fit, and diagnose again",
      better, claimed);
}

void add_notes(Diagnosis& diagnosis, std::vector<std::string> lines) {
  std::ranges::move(lines, std::back_inserter(diagnosis.notes));
}

void settle(Diagnosis& diagnosis, ImpactStudy& study, const Studied& current,
            const ImpactDisbelief& disbelief) {
  settle_claims(diagnosis, current.model,
                [&](CandidateResult& result) { set_strength(current, result.effect, result); });
  add_notes(diagnosis, left_notes(study, current, diagnosis.held_out));
  add_notes(diagnosis, disbelief.reasons);
  if (diagnosis.verdict == DiagnosisVerdict::adequate && disbelief.taken_up) {
    diagnosis.verdict = DiagnosisVerdict::untestable;
  }
}

void add_next_impacts(Diagnosis& diagnosis) {
  for (const std::string& id : diagnosis.effects) {
    if (std::vector<std::string> tied = diagnosis.tied_with[id]; !tied.empty()) {
      tied.insert(tied.begin(), id);
      diagnosis.next_experiment.push_back(next_impact(tied));
    }
  }
}

void reject_what_quiet_lacks(Diagnosis& diagnosis, const std::set<std::string>& not_in_quiet) {
  for (const std::string& id : not_in_quiet) {
    if (std::ranges::count(diagnosis.effects, id) == 0) {
      set_verdict(diagnosis, id, CandidateVerdict::rejected);
    }
  }
}

}  // namespace

Diagnosis conclude(ImpactStudy& study, const ImpactFindings& found,
                   const DiagnosisOptions& options) {
  Diagnosis diagnosis = found.diagnosis;
  diagnosis.before = found.first.misfit;
  diagnosis.after = found.current.misfit;
  diagnosis.model = found.current.model;
  diagnosis.held_out = held_out_of(study, found, options.log_alpha);
  diagnosis.unexplained_log_p = study.unexplained_log_p(found.current.fit.residual);
  const ImpactDisbelief disbelief =
      disbelief_in(found, diagnosis.held_out, options.log_alpha, study);
  const double floor = diagnosis.held_out.floor;
  if (disbelief.gives_up) {
    give_up(diagnosis, disbelief.reasons, found.first.model, floor);
  } else if (const auto better = better_than_claimed(study, found, options)) {
    const std::vector<std::string> claimed = drop_claims(diagnosis);
    give_up(diagnosis, {overruled_note(*better, claimed.front())}, found.first.model, floor);
  } else {
    settle(diagnosis, study, found.current, disbelief);
  }
  add_next_impacts(diagnosis);
  reject_what_quiet_lacks(diagnosis, found.not_in_quiet);
  add_notes(diagnosis,
            impact_notes(study, found.current, diagnosis.candidates, found.scale, found.flat));
  return diagnosis;
}

}  // namespace kolsky

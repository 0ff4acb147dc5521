#include "processing/criticism/verdict/claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kolsky {

void set_verdict(Diagnosis& diagnosis, const std::string& id, CandidateVerdict verdict) {
  for (CandidateResult& result : diagnosis.candidates) {
    if (result.effect == id) {
      result.verdict = verdict;
    }
  }
}

void drop_claim(Diagnosis& diagnosis, const std::string& id, CandidateVerdict verdict) {
  std::erase(diagnosis.effects, id);
  diagnosis.tied_with.erase(id);
  set_verdict(diagnosis, id, verdict);
}

std::vector<std::string> drop_claims(Diagnosis& diagnosis) {
  std::vector<std::string> claimed = std::exchange(diagnosis.effects, {});
  diagnosis.tied_with.clear();
  for (const std::string& id : claimed) {
    set_verdict(diagnosis, id, CandidateVerdict::rejected);
  }
  return claimed;
}

void give_up(Diagnosis& diagnosis, const std::vector<std::string>& reasons, const Model& before,
             double floor) {
  diagnosis.verdict = DiagnosisVerdict::unknown;
  diagnosis.notes.insert(diagnosis.notes.end(), reasons.begin(), reasons.end());
  std::string nearest;
  for (const std::string& id : drop_claims(diagnosis)) {
    nearest += (nearest.empty() ? "" : " with ") + id;
  }
  if (!nearest.empty()) {
    diagnosis.notes.push_back(fmt::format(
        "nearest came {}: held-out misfit {:.3g} -> {:.3g}, noise alone {:.3g}", nearest,
        diagnosis.held_out.before, diagnosis.held_out.after, diagnosis.held_out.floor));
  }
  diagnosis.model = before;
  diagnosis.after = diagnosis.before;
  diagnosis.held_out.after = diagnosis.held_out.before;
  diagnosis.held_out.floor = floor;
}

namespace {

/// How far a claimed strength is off where it is not there yet; infinite where what is told is
/// another number, as the return of an end that was not there.
double size_of(const CandidateResult& result, const Model& found) {
  const EffectUse* use = found.find(result.effect);
  if (use == nullptr) {
    return std::numeric_limits<double>::infinity();
  }
  const EffectAbout& about = use->effect->about();
  if (about.quadrature) {
    return result.strength;
  }
  return result.parameter == about.parameters.front().name
             ? std::abs(result.strength - about.parameters.front().null_value)
             : std::numeric_limits<double>::infinity();
}

}  // namespace

void settle_claims(Diagnosis& diagnosis, const Model& found,
                   const std::function<void(CandidateResult&)>& set_strength) {
  diagnosis.verdict =
      diagnosis.effects.empty() ? DiagnosisVerdict::adequate : DiagnosisVerdict::named;
  for (const std::string& id : diagnosis.effects) {
    std::vector<std::string>& ties = diagnosis.tied_with[id];
    std::erase_if(ties, [&](const std::string& other) {
      return std::ranges::count(diagnosis.effects, other) > 0;
    });
    set_verdict(diagnosis, id, ties.empty() ? CandidateVerdict::named : CandidateVerdict::tied);
    for (const std::string& other : ties) {
      set_verdict(diagnosis, other, CandidateVerdict::tied);
      diagnosis.verdict = DiagnosisVerdict::tied;
    }
  }
  for (CandidateResult& result : diagnosis.candidates) {
    if (std::ranges::count(diagnosis.effects, result.effect) > 0) {
      set_strength(result);
      // First order about null does not see all that some effects do; the refits did, at this size.
      const double size = size_of(result, found);
      result.detectable = std::min(result.detectable, size);
      if (result.verdict == CandidateVerdict::named) {
        result.identifiable = std::min(result.identifiable, size);
      }
    }
  }
}

}  // namespace kolsky

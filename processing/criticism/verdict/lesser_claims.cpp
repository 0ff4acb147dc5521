#include "processing/criticism/verdict/lesser_claims.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/doubts.hpp"
#include "processing/criticism/verdict/other_law.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/criticism/verdict/slow_ties.hpp"
#include "processing/criticism/verdict/small_rest.hpp"

namespace kolsky {

namespace {

/// A third beside a solid's formula that explains next to nothing of what the others do is what
/// these leave.
void set_dwarfed_aside(Study& study, const DiagnosisOptions& options, Findings& found) {
  const std::vector<std::string>& effects = found.diagnosis.effects;
  if (!options.safeguards.unknown || beside_the_bar(effects).size() <= kMostBelieved) {
    return;
  }
  const double noise = noise_of(found.current.misfit, study.campaign().shots.size());
  const ClaimGains gains = claim_gains(study, found.current, effects, noise);
  if (const std::optional<std::string> id = dwarfed(gains)) {
    found.set_aside = {*id, gains.others.at(*id), dwarfed_text(gains, *id)};
    drop(found, *id, CandidateVerdict::rejected, without(study, found.current, *id));
  }
}

/// What a specimen departs from a claimed law by, and is next to nothing of what that explains, is
/// what the law's formula leaves: no second claim, and nothing against the first.
void set_what_a_law_leaves_aside(Study& study, const DiagnosisOptions& options, Findings& found) {
  if (!options.safeguards.unknown || found.diagnosis.effects.size() != 2) {
    return;
  }
  auto other = other_law_in_place_of(study, found.current, found.diagnosis.effects);
  if (!other) {
    return;
  }
  const double objective = found.current.fit.objective();
  const double explained = found.first.fit.objective() - objective;
  const double by_claim = other->without.fit.objective() - objective;
  if (by_claim < kAllowedRest * explained) {
    found.diagnosis.notes.push_back(
        fmt::format("{} would explain {:.1g} % of what {} does: by so much a specimen may depart "
                    "from that law",
                    other->claim, 100.0 * by_claim / explained, other->law));
    drop(found, other->claim, CandidateVerdict::rejected, std::move(other->without));
  }
}

/// Strengths that every gauge has of its own lean to none, since what all gauges have alike could
/// be the source's: where one for all does as well, it is that.
void make_alike(Study& study, Findings& found) {
  constexpr double kNoWorse = -4.6;
  Studied& current = found.current;
  for (const std::string& id : found.diagnosis.effects) {
    Model model = current.model;
    EffectUse* use = model.find(id);
    if (use == nullptr || !use->per_shot || !use->effect->about().each_gauge || use->alike) {
      continue;
    }
    use->alike = true;
    Studied alike = changed(study, current, model);
    const double freedom = alike.fit.degrees_of_freedom(alike.composition) -
                           current.fit.degrees_of_freedom(current.composition);
    const double loss = (alike.fit.objective() - current.fit.objective()) /
                        noise_of(current.misfit, study.campaign().shots.size());
    if (freedom > 0.0 && log_chi2_tail(std::max(loss, 0.0), freedom) > kNoWorse) {
      current = std::move(alike);
    }
  }
}

/// A drift is no claim beside a hum whose unequal shares do as well.
void set_drifts_of_shares_aside(Study& study, Findings& found) {
  auto hum = hum_in_shares(study, found.current, found.diagnosis.effects);
  if (!hum) {
    return;
  }
  for (const std::string& drift : hum->drifts) {
    drop(found, drift, CandidateVerdict::not_needed, hum->studied);
  }
}

}  // namespace

void set_lesser_claims_aside(Study& study, const DiagnosisOptions& options, Findings& found) {
  set_dwarfed_aside(study, options, found);
  set_what_a_law_leaves_aside(study, options, found);
  make_alike(study, found);
  set_drifts_of_shares_aside(study, found);
}

}  // namespace kolsky

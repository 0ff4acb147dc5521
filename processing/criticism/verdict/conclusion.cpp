#include "processing/criticism/verdict/conclusion.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/records/arrival_order.hpp"
#include "processing/criticism/search/safeguards.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/verdict/at_bounds.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/complement.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/doubts.hpp"
#include "processing/criticism/verdict/loud_pulses.hpp"
#include "processing/criticism/verdict/refits.hpp"
#include "processing/criticism/verdict/small_rest.hpp"
#include "processing/criticism/verdict/strength_notes.hpp"
#include "processing/criticism/verdict/unexplained.hpp"

namespace kolsky {

namespace {

/// @param studied  what the residuals are frozen for: what was bent is straightened with what they
///                 left then, and without that fit they are another's
double misfit_held_out(const Studied& studied, Study& study) {
  return held_out_misfit(held_out_squares(studied, study), studied.fit.penalty,
                         static_cast<double>(study.residuals().size()));
}

/// What the model leaves with all that is claimed.
struct Remainder {
  Unexplained unexplained;
  double excess = 0.0;           ///< chi2 beyond what noise leaves, of all that repeats
  bool more = false;             ///< than noise leaves, and than a claim does of what it explains
  std::optional<SmallRest> own;  ///< where it is so little beside the claims that it is theirs

  [[nodiscard]] bool is_of_something_else() const { return more && !own; }
};

/// Shots that ask for moduli or readings of their own may leave no more than noise does. What a
/// claim leaves of what it explains is its own inexactness only while noise might leave as much:
/// ends that return waves explain so much that anything else would be less than a share of it.
/// @param explained  of chi2, by what is claimed
bool is_more(const Remainder& rest, double explained, std::size_t effects,
             const DiagnosisOptions& options) {
  const double log_p = rest.unexplained.log_p;
  return log_p < options.log_alpha &&
         (effects == 0 || log_p < kSure ||
          rest.excess > allowed_rest(effects) * std::max(0.0, explained));
}

/// What claims beside a solid's formula leave, where it is so little of what they explain that it
/// is their own; it is told, and counts in their deviations.
std::optional<SmallRest> own_rest(Study& study, const DiagnosisOptions& options,
                                  const Findings& found, const Remainder& rest, double noise) {
  constexpr double kSpread = 2.0;  // deviations of what noise leaves of all that repeats
  const std::vector<std::string>& effects = found.diagnosis.effects;
  if (!options.safeguards.unknown || beside_the_bar(effects).size() < 2 ||
      rest.unexplained.apart.log_p < options.log_alpha || !(rest.more || found.set_aside)) {
    return std::nullopt;
  }
  const double repeated = repeated_excess(study, found.current) -
                          kSpread * std::sqrt(2.0 * found.current.misfit.degrees_of_freedom);
  const double chi2 = std::max(found.set_aside ? found.set_aside->gain : 0.0,
                               rest.more ? std::max(rest.unexplained.excess, repeated) : 0.0);
  ClaimGains gains = claim_gains(study, found.current, effects, noise);
  return chi2 < small_rest(gains) ? std::optional(SmallRest{std::move(gains), chi2}) : std::nullopt;
}

/// @param before  without what is claimed
Remainder remainder_of(Study& study, const DiagnosisOptions& options, const Findings& found,
                       const Studied& before, const Unexplained& unexplained, double noise) {
  // Smooth distortions show that something is left; how much, all that repeats.
  Remainder rest{.unexplained = unexplained,
                 .excess = std::max(unexplained.excess, repeated_excess(study, found.current)),
                 .own = {}};
  const double explained = (before.fit.objective() - found.current.fit.objective()) / noise;
  rest.more = is_more(rest, explained, found.diagnosis.effects.size(), options);
  rest.own = own_rest(study, options, found, rest, noise);
  return rest;
}

/// Where nothing comes back and nothing is claimed, by the noise of the quiet parts.
std::optional<std::string> loud_pulses(Study& study, const Studied& current) {
  const std::vector<LoudPulses> loud = loudness_of_pulses(study, current);
  return study.campaign().shots.size() > 1 && beyond_noise(loud.front())
             ? std::optional(loud_text(loud, study.campaign()))
             : std::nullopt;
}

/// What the strengths found do not say by themselves.
void note_strengths(const Findings& found, const std::optional<SmallRest>& own,
                    std::vector<std::string>& notes) {
  if (own) {
    notes.push_back(small_rest_text(*own, found.set_aside ? found.set_aside->effect : ""));
  }
  for (const AtBound& number : claimed_at_bounds(found)) {
    notes.push_back(in_words(number));
  }
  const Model& model = found.current.model;
  for (const std::string& id : found.diagnosis.effects) {
    const EffectUse* use = model.find(id);
    if (use == nullptr) {
      continue;
    }
    for (const auto& text :
         {either_branch_text(model, id), unlike_formula_text(*use), only_begins_text(*use)}) {
      if (text) {
        notes.push_back(*text);
      }
    }
  }
}

void settle(Study& study, const std::optional<SmallRest>& own, Findings& found) {
  Diagnosis& diagnosis = found.diagnosis;
  tie_with_complement(study, found);
  settle_claims(diagnosis, found.current.model, [&](CandidateResult& result) {
    set_strength(found.current, result.effect, study.residuals().per_shot(), result);
    result.sd = std::hypot(result.sd, found.variants_differ[result.effect],
                           share_moved(own, result.effect) * result.strength);
  });
  note_strengths(found, own, diagnosis.notes);
  if (blames_bar_of_two_gauges(diagnosis, study.campaign())) {
    diagnosis.notes.push_back(two_gauges_text());
  }
  if (blames_times_of_several_gauges(diagnosis, study.campaign())) {
    diagnosis.notes.push_back(several_times_text());
  }
  if (blames_even_loss(diagnosis)) {
    diagnosis.notes.push_back(even_loss_text());
  }
}

void note_one_shot(Diagnosis& diagnosis) {
  diagnosis.notes.emplace_back(
      "one shot: held out were parts of its record, not shots; repeat the shot to certify");
  if (diagnosis.verdict == DiagnosisVerdict::adequate && beyond_quiet(diagnosis.held_out)) {
    diagnosis.notes.push_back(left_of_one_shot_text("the model", diagnosis.held_out.after));
  }
}

}  // namespace

std::optional<LeftOver> conclude(Study& study, const DiagnosisOptions& options, Findings& found) {
  options.progress("looking for what nothing explains");
  const std::size_t shots = study.campaign().shots.size();
  const Studied& current = found.current;
  Diagnosis& diagnosis = found.diagnosis;
  const Unexplained left = unexplained(study, current);
  const bool nothing_claimed = diagnosis.effects.empty();
  const double misfit_after = misfit_held_out(current, study);
  // Both by the same measure of the noise, which what was found and let go again has changed.
  const Studied before = nothing_claimed ? current : study.refit(found.first);
  const double misfit_before = nothing_claimed ? misfit_after : misfit_held_out(before, study);
  diagnosis.unexplained_log_p = left.log_p;
  diagnosis.before = before.misfit;
  diagnosis.after = current.misfit;
  diagnosis.model = current.model;
  const double noise = noise_of(current.misfit, shots);
  const Remainder rest = remainder_of(study, options, found, before, left, noise);
  diagnosis.held_out = {
      misfit_before, misfit_after,
      floor_of(current, left.log_p < options.log_alpha ? Left::more : Left::noise, shots)};
  std::vector<std::string> reasons =
      doubts(study, options, found, before,
             rest.is_of_something_else() ? std::optional(left) : std::nullopt, noise);
  if (found.set_aside && !rest.own) {
    reasons.push_back(found.set_aside->text);
  }
  if (reasons.empty() && !nothing_claimed) {
    // What an effect makes of gauges that are exchanged is no effect.
    reasons = misfiled_gauges(study.campaign());
  }
  const bool doubted = !reasons.empty();
  if (options.safeguards.unknown && !doubted && diagnosis.effects.empty()) {
    if (auto loud = loud_pulses(study, current)) {
      reasons.push_back(*std::move(loud));
    }
  }
  std::optional<LeftOver> left_over;
  if (reasons.empty()) {
    settle(study, rest.own, found);
  } else {
    give_up(diagnosis, reasons, before.model, floor_of(before, Left::more, shots));
    if (const auto where = doubted ? where_text(loudness_of_pulses(study, before), study.campaign())
                                   : std::nullopt) {
      diagnosis.notes.push_back(*where);
    }
    left_over = {rest.excess, rest.is_of_something_else() && left.common_log_p < options.log_alpha};
  }
  if (shots < 2) {
    note_one_shot(diagnosis);
  }
  return left_over;
}

}  // namespace kolsky

#include "processing/criticism/verdict/choice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "processing/criticism/search/amplitude_over_shots.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

/// A rival may be so much likelier to be chance than what may be named.
constexpr double kRivalChance = 10.0;

double strength_of(const Studied& studied, const std::string& id) {
  const EffectUse& use = *studied.model.find(id);
  if (use.effect->about().quadrature && use.per_shot) {
    return amplitude_over_shots(studied, id).value;
  }
  CandidateResult result;
  set_strength(studied, id, result);
  return result.strength;
}

/// Whether two fits of an effect differ in what is chosen among a few, as a hum's frequency is.
bool chosen_apart(const Studied& one, const Studied& other, const std::string& id) {
  const EffectUse& a = *one.model.find(id);
  const EffectUse& b = *other.model.find(id);
  const auto& parameters = a.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].chosen && a.values[p].value != b.values[p].value) {
      return true;
    }
  }
  return false;
}

/// Strengths of each shot's own that no other shot can foretell: products are foretold by the other
/// gauges, and what slow noise does not do by what comes before and after.
bool confirmed_otherwise(const Refit& refit) {
  return refit.products.has_value() || refit.slow.has_value();
}

std::string id_of(const Search& search, const Refit& refit) {
  return search.candidates()[refit.candidate].id();
}

const EffectUse& fitted_use(const Search& search, const Refit& refit) {
  return *refit.studied.model.find(id_of(search, refit));
}

}  // namespace

double tie_limit(const EffectUse& best, const EffectUse& rival) {
  constexpr double kAbout = 2.0 / 3.0;
  return agrees_with_formula(rival, kAbout) && !agrees_with_formula(best, kAbout) ? 2.0 * kTie
                                                                                  : kTie;
}

std::optional<Choice> Chooser::choose_first(Search& search, const Studied& base,
                                            const std::vector<std::string>& barred) {
  Found found = found_by(search, base, barred);
  note_all(found);
  Places places = places_of(found);
  if (places.best) {
    const std::optional<double> ahead = lead_over_next(found, *places.best);
    Choice choice = chosen(found, std::move(places));
    choice.lead_over_next = ahead;
    return choice;
  }
  if (!places.nearest || !barred.empty()) {
    return std::nullopt;
  }
  // Shots may differ by what is missing beside it.
  Refit& nearest = found.refits[*places.nearest];
  return Choice{.id = id_of(search, nearest),
                .candidate = nearest.candidate,
                .studied = std::move(nearest.studied),
                .ties = {},
                .on_trial = true};
}

std::optional<Choice> Chooser::choose_next(Search& search, const Studied& base) {
  const std::vector<std::string> none;
  Found found = found_by(search, base, none);
  Places places = places_of(found);
  return places.best ? std::optional(chosen(found, std::move(places))) : std::nullopt;
}

Chooser::Found Chooser::found_by(Search& search, const Studied& base,
                                 const std::vector<std::string>& barred) {
  Found found{search, search.refit_rivals(), {}, barred};
  found.held_out = certify(search, found.refits, base);
  return found;
}

void Chooser::note_all(const Found& found) {
  std::vector<std::size_t> all(found.refits.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  note_refits(found.search, found.refits, found.held_out, all, study_.residuals().per_shot(),
              diagnosis_.candidates);
  for (CandidateResult& result : diagnosis_.candidates) {
    const auto dismissed = found.search.dismissed().find(result.effect);
    if (dismissed == found.search.dismissed().end() ||
        std::ranges::any_of(found.refits, [&](const Refit& own) {
          return id_of(found.search, own) == result.effect;
        })) {
      continue;
    }
    if (!result.per_shot && dismissed->second.gain < result.gain) {
      result.gain = dismissed->second.gain;
      result.own_log_p = dismissed->second.chance;
      result.log_p = found.search.with_search(dismissed->second.chance);
    }
    // What gains no more than noise does came into no question that it could fail.
    if (result.log_p <= least_plausible()) {
      result.verdict = dismissed->second.verdict;
    }
  }
}

Chooser::Places Chooser::places_of(const Found& found) {
  Places places;
  std::optional<std::size_t> leading;
  for (std::size_t i = 0; i < found.refits.size(); ++i) {
    const Refit& refit = found.refits[i];
    // What slow noise does by itself is no rival.
    if (!plausible(found.search, refit) || is_barred(found, i)) {
      continue;
    }
    const bool may_be_named = claimable(found.search, refit);
    leading = may_be_named && !leading ? i : leading;
    const bool is_sound = sound(found, i);
    const Refit& ahead = found.refits[places.best.value_or(leading.value_or(i))];
    const double limit =
        places.best ? tie_limit(fitted_use(found.search, ahead), fitted_use(found.search, refit))
                    : kTie;
    if (leading && lead(ahead, refit) > limit) {
      // What is ahead may only be so for want of another.
      places.nearest = is_sound && may_be_named && !places.nearest ? i : places.nearest;
      continue;
    }
    if (!is_sound || !agreed(found, i)) {
      set_verdict(diagnosis_, id_of(found.search, refit), CandidateVerdict::rejected);
      places.nearest = is_sound && may_be_named && !places.nearest ? i : places.nearest;
      continue;
    }
    places.confirmed.push_back(i);
    places.best = may_be_named && !places.best ? i : places.best;
  }
  prefer_library(found, places);
  return places;
}

bool Chooser::is_barred(const Found& found, std::size_t i) {
  return std::ranges::count(found.barred, id_of(found.search, found.refits[i])) > 0;
}

std::optional<double> Chooser::lead_over_next(const Found& found, std::size_t best) const {
  const Refit& ahead = found.refits[best];
  for (std::size_t i = 0; i < found.refits.size(); ++i) {
    const Refit& next = found.refits[i];
    if (id_of(found.search, next) != id_of(found.search, ahead) && !is_barred(found, i) &&
        claimable(found.search, next) && sound(found, i) && agreed(found, i)) {
      // In deviations alone a lead is never more than what is known of the noise allows.
      return std::max(lead(ahead, next), ahead.over_noise - next.over_noise);
    }
  }
  return std::nullopt;
}

/// A formula of the user's own can be made to fit anything: it stands for no tie that an effect of
/// the library is in.
void Chooser::prefer_library(const Found& found, Places& places) const {
  const auto own_formula = [&](std::size_t i) {
    const Effect* effect = found.search.candidates()[found.refits[i].candidate].use.effect;
    return std::ranges::count(effect_library(), effect) == 0;
  };
  if (!places.best || !own_formula(*places.best)) {
    return;
  }
  for (const std::size_t i : places.confirmed) {
    if (!own_formula(i) && claimable(found.search, found.refits[i])) {
      places.best = i;
      return;
    }
  }
}

bool Chooser::sound(const Found& found, std::size_t i) const {
  const Refit& refit = found.refits[i];
  const Certification& own = found.held_out[i];
  // What each shot has its own of, few have much of, and the rest say nothing of.
  constexpr double kMost = 0.5;
  const bool of_shots_own = fitted_use(found.search, refit).per_shot;
  const bool foretells_most =
      confirmed_otherwise(refit) || (own.gain > 0.0 && (of_shots_own || own.share > kMost));
  constexpr double kSlack = 1.5;
  return (!options_.safeguards.held_out || foretells_most) &&
         !beyond_belief(refit.studied, id_of(found.search, refit), study_.campaign(), kSlack);
}

/// What shots foretell of each other is nearly all that a true effect gains (0.77 of it and more in
/// 110 claims), and next to nothing of what noise of one of them asks for.
bool Chooser::foretold(const Found& found, std::size_t i) const {
  constexpr double kShare = 0.3;
  const Refit& refit = found.refits[i];
  // Of two shots, or parts of one, each is half of all that is known.
  return !options_.safeguards.held_out || confirmed_otherwise(refit) ||
         study_.campaign().shots.size() < 3 ||
         found.held_out[i].gain > kShare * refit.noise * refit.gain;
}

bool Chooser::agreed(const Found& found, std::size_t i) const {
  const Refit& refit = found.refits[i];
  return foretold(found, i) && (!options_.safeguards.shot_agreement ||
                                shots_agree(refit.studied, refit.gain, id_of(found.search, refit),
                                            study_.campaign(), study_.residuals().per_shot()));
}

Choice Chooser::chosen(Found& found, Places places) {
  const std::size_t best = *places.best;
  const std::string id = id_of(found.search, found.refits[best]);
  std::vector<std::string> ties;
  double variants_differ = 0.0;
  for (const std::size_t i : places.confirmed) {
    const std::string other = id_of(found.search, found.refits[i]);
    if (!(lead(found.refits[i], found.refits[best]) < kTie)) {
      continue;
    }
    // One and the same may stand there twice, with its strengths alike or each shot's own.
    if (other != id) {
      if (std::ranges::count(ties, other) == 0) {
        ties.push_back(other);
      }
    } else if (chosen_apart(found.refits[i].studied, found.refits[best].studied, id)) {
      variants_differ =
          std::max(variants_differ, std::abs(strength_of(found.refits[i].studied, id) -
                                             strength_of(found.refits[best].studied, id)));
    }
  }
  // An effect's variant that is confirmed stands for it, wherever it stands among them.
  std::stable_partition(places.confirmed.begin(), places.confirmed.end(),
                        [&](std::size_t i) { return i == best; });
  note_refits(found.search, found.refits, found.held_out, places.confirmed,
              study_.residuals().per_shot(), diagnosis_.candidates);
  Refit& refit = found.refits[best];
  return Choice{.id = id,
                .candidate = refit.candidate,
                .studied = std::move(refit.studied),
                .ties = std::move(ties),
                .variants_differ = variants_differ};
}

bool Chooser::claimable(const Search& search, const Refit& refit) const {
  return search.with_search(refit.log_p) <= options_.log_alpha && states_a_strength(search, refit);
}

/// A hum may gain much of whatever one gauge alone reads slowly, a step or a droop, by an amplitude
/// that is none beside its deviation. (True ones in unequal shares, of which a free source takes up
/// a part, may be known to no better than their size.)
bool Chooser::states_a_strength(const Search& search, const Refit& refit) const {
  const EffectUse& use = fitted_use(search, refit);
  if (!use.effect->about().quadrature || use.alike) {
    return true;
  }
  constexpr double kLeast = 0.75;
  CandidateResult stated;
  set_strength(refit.studied, use.id(), study_.residuals().per_shot(), stated);
  return stated.strength >= kLeast * stated.sd;
}

/// Too little to be named by itself, enough not to be told from what is named with hardly more.
bool Chooser::plausible(const Search& search, const Refit& refit) const {
  return search.with_search(std::min(refit.log_p, refit.rival_log_p)) <= least_plausible();
}

double Chooser::least_plausible() const {
  return options_.log_alpha + std::log(kRivalChance);
}

/// Exact for those that may be named; of the others first order tells enough.
std::vector<Certification> Chooser::certify(const Search& search, const std::vector<Refit>& refits,
                                            const Studied& base) const {
  const auto leading =
      std::ranges::find_if(refits, [&](const Refit& refit) { return claimable(search, refit); });
  // The best that is sound may be one tie behind, its formula's rival two behind that.
  constexpr double kNearest = 3.0 * kTie;
  std::vector<Certification> held_out;
  const std::vector<double> before = held_out_squares(base, study_);
  for (const Refit& refit : refits) {
    const bool near =
        leading != refits.end() && plausible(search, refit) && lead(*leading, refit) < kNearest;
    const Studied& own = refit.studied;
    held_out.push_back(certification(
        before, near ? held_out_squares(own, study_) : foretold_squares(own, study_),
        base.fit.penalty - own.fit.penalty,
        shot_strengths(own, id_of(search, refit), study_.residuals().per_shot()).weight));
  }
  return held_out;
}

}  // namespace kolsky

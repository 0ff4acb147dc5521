#include "processing/criticism/impact/impact_diagnosis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <utility>

#include "processing/criticism/impact/impact_certifier.hpp"
#include "processing/criticism/impact/impact_notes.hpp"
#include "processing/criticism/impact/impact_search.hpp"
#include "processing/criticism/impact/impulse_doubt.hpp"
#include "processing/criticism/impact/next_impact.hpp"
#include "processing/criticism/impact/rival_readings.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/filed_conflict.hpp"

namespace kolsky {

namespace {

constexpr double kAllowedRest = 0.03;   ///< of a misfit that certified effects explain
constexpr double kWorthAllowing = 0.8;  ///< of the solver's usual share: less is not worth it

/// A number that every model here holds has no place to be taken from.
bool is_filed(const Studied& first, const std::string& id) {
  return first.model.find(id) != nullptr;
}

/// What the library has of a ball's materials beyond the model.
std::vector<std::string> of_materials(const Model& model) {
  std::vector<std::string> list;
  for (const Effect* effect : effect_library()) {
    const EffectAbout& about = effect->about();
    if (!about.base && about.stage == Stage::specimen && model.find(about.id) == nullptr &&
        std::ranges::count(about.kinds, BenchKind::impact) > 0) {
      list.push_back(about.id);
    }
  }
  return list;
}

class Diagnostician {
 public:
  Diagnostician(ImpactStudy& study, const DiagnosisOptions& options)
      : study_(study), options_(options), certifier_(study, options.log_alpha) {}

  Diagnosis run(const Model& model, ImpactsSeen* seen) {
    options_.progress(fmt::format("impacts at {} speeds on {} and {} elements, then the fit",
                                  study_.residuals().records().groups.size(),
                                  study_.residuals().meshes().fine,
                                  study_.residuals().meshes().middle));
    Studied first = study_.fit(model);
    first_anchor_ = study_.residuals().anchored_at();
    options_.progress("testing every effect of the library");
    std::optional<ImpactSearch> search(std::in_place, study_, first);
    if (const double share = search->solver_share(); share < kWorthAllowing) {
      first = study_.allowing(share, first);
      settled_roughly_ = true;
      search.emplace(study_, first);
    }
    searched_ = search->base().fit.objective();
    Studied current = first;
    while ((add_one(*search, current, true) || add_two(current)) &&
           diagnosis_.effects.size() < options_.most_effects) {
      options_.progress("testing what remains after " + diagnosis_.effects.back());
      search.emplace(study_, current);
    }
    weigh_beside_others(first, current);
    weigh_beside_rest(first);
    weigh_readings(first, current);
    if (settled_roughly_ && !surely_given_up(first, current)) {
      options_.progress("fitting what is said to its end");
      current = study_.polished(current);
    }
    conclude(first, current);
    ImpactComparison after = study_.compare(current);
    add_notes(restitution_notes(after));
    if (seen != nullptr) {
      seen->before = diagnosis_.effects.empty() ? after : compared_at_first(first);
      seen->after = std::move(after);
    }
    return std::move(diagnosis_);
  }

 private:
  /// @param settled  the model that was searched for what it lacks
  bool add_one(ImpactSearch& search, Studied& current, bool settled) {
    options_.progress("refitting rivals");
    std::vector<ImpactRefit> refits = search.refits();
    scale_ = search.scale();
    if (diagnosis_.candidates.empty()) {
      begin_table(search, refits);
    }
    const ImpactRefit* claimed = first_certified(search, refits, search.base());
    unbelievable_ = certifier_.unbelievable(search, refits, search.base());
    if (claimed == nullptr && settled && diagnosis_.effects.empty() &&
        study_.allowance(current) != Allowance::kept) {
      options_.progress("fitting the nearest to a claim to their ends");
      refits = search.settled(std::move(refits), current);
      scale_ = search.scale();
      claimed = first_certified(search, refits, current);
    }
    if (claimed == nullptr) {
      rest_.reset();
      // A filed number that is set free has its place in every model already.
      if (!refits.empty() && refits.front().evidence > kStandsBefore &&
          !search.candidate(refits.front()).frees_prior) {
        rest_ = Rest{search.candidate(refits.front()).id(), refits.front().studied};
      }
      return false;
    }
    const std::string id = search.candidate(*claimed).id();
    diagnosis_.effects.push_back(id);
    diagnosis_.tied_with[id] = beside(search, refits, *claimed);
    take(claimed->studied, current);
    return true;
  }

  /// Where two are missing, each spoils what the other foretells. So what came nearest to a claim
  /// takes its place, and is weighed beside the next (weigh_beside_others), if that is certified.
  bool add_two(Studied& current) {
    if (!rest_ || diagnosis_.effects.size() + 2 > options_.most_effects) {
      return false;
    }
    options_.progress("testing two effects, of which one is " + rest_->id);
    const Rest nearest = *rest_;
    const std::optional<std::string> unbelievable = unbelievable_;
    Studied beside = nearest.studied;
    ImpactSearch search(study_, beside);
    const std::size_t place = diagnosis_.effects.size();
    if (!add_one(search, beside, false)) {
      rest_ = nearest;
      unbelievable_ = unbelievable;
      return false;
    }
    diagnosis_.effects.insert(diagnosis_.effects.begin() + static_cast<std::ptrdiff_t>(place),
                              nearest.id);
    current = std::move(beside);
    return true;
  }

  [[nodiscard]] const ImpactRefit* first_certified(const ImpactSearch& search,
                                                   const std::vector<ImpactRefit>& refits,
                                                   const Studied& base) {
    note_not_in_quiet(search);
    std::vector<std::string> judged;
    const ImpactRefit* claimed = certifier_.first_certified(search, refits, base, judged);
    for (const std::string& id : judged) {
      set_verdict(diagnosis_, id, "rejected");
    }
    if (claimed != nullptr) {
      judged.push_back(search.candidate(*claimed).id());
      std::ranges::copy(beside(search, refits, *claimed), std::back_inserter(judged));
    }
    note_refits(search, refits, judged);
    return claimed;
  }

  /// What would explain much but for the quiet before the pulse, which does not hold it.
  void note_not_in_quiet(const ImpactSearch& search) {
    for (const std::string& id : search.not_in_quiet()) {
      if (not_in_quiet_.insert(id).second) {
        diagnosis_.notes.push_back(id +
                                   " is not claimed: what it would add to the records is not in "
                                   "them before the pulse");
      }
    }
  }

  void take(const Studied& refit, Studied& current) {
    searched_ = refit.fit.objective();
    // Refits borrow their derivatives, and their fine forces from a ball without the effect.
    current = study_.settled(refit, Settle::roughly);
    settled_roughly_ = true;
    anchor_.emplace(AnchoredAt{current.composition, current.fit.theta});
  }

  [[nodiscard]] Studied without(const Model& model, const std::string& id) {
    Model others = model;
    std::erase_if(others.effects, [&](const EffectUse& use) { return use.id() == id; });
    return study_.refit(others, study_.executor());
  }

  /// What was found before other effects were may have stood for a mix of them, or be tied with one
  /// that is in the model by now: each again in its place beside the others, until all stay.
  void weigh_beside_others(const Studied& first, Studied& current) {
    constexpr int kMostPasses = 3;
    bool moved = diagnosis_.effects.size() > 1;
    for (int pass = 0; moved && pass < kMostPasses; ++pass) {
      moved = false;
      for (const std::string& id : std::vector<std::string>(diagnosis_.effects)) {
        moved = (!is_filed(first, id) && moves_beside_others(id, current)) || moved;
      }
    }
  }

  /// @return whether another took its place, or none
  bool moves_beside_others(const std::string& id, Studied& current) {
    options_.progress("weighing " + id + " beside what else was found");
    const Studied others = without(current.model, id);
    ImpactSearch search(study_, others);
    const std::vector<ImpactRefit> refits = search.refits();
    const ImpactRefit* claimed = first_certified(search, refits, search.base());
    if (claimed == nullptr) {
      drop_claim(diagnosis_, id, "rejected");
      take(others, current);
      return true;
    }
    const std::string now = search.candidate(*claimed).id();
    std::replace(diagnosis_.effects.begin(), diagnosis_.effects.end(), id, now);
    diagnosis_.tied_with.erase(id);
    diagnosis_.tied_with[now] = beside(search, refits, *claimed);
    if (now == id) {
      return false;
    }
    set_verdict(diagnosis_, id, "rejected");
    take(claimed->studied, current);
    return true;
  }

  /// What is left may hold an effect that is not certified by itself. With it in the model, what
  /// was claimed may be tied with more.
  void weigh_beside_rest(const Studied& first) {
    if (!rest_ || diagnosis_.effects.empty()) {
      return;
    }
    for (const std::string& id : diagnosis_.effects) {
      options_.progress("weighing " + id + " beside " + rest_->id);
      if (is_filed(first, id) || rest_->studied.model.find(id) == nullptr) {
        continue;
      }
      const Studied others = without(rest_->studied.model, id);
      ImpactSearch search(study_, others);
      const std::vector<ImpactRefit> refits = search.refits();
      const auto own = std::ranges::find_if(
          refits, [&](const ImpactRefit& refit) { return search.candidate(refit).id() == id; });
      if (own == refits.end()) {
        continue;
      }
      std::vector<std::string>& ties = diagnosis_.tied_with[id];
      for (const std::string& other : beside(search, refits, *own)) {
        if (std::ranges::find(ties, other) == ties.end()) {
          ties.push_back(other);
        }
      }
    }
    diagnosis_.notes.push_back(
        "what is claimed leaves something that is not certified; nearest is " + rest_->id);
  }

  /// A search goes by derivatives from where the model was led for want of what is missing, and
  /// what a ball's materials do has none worth anything there. So where one effect is claimed and
  /// leaves what stands out, the others of the materials are fitted to their ends as well: one that
  /// explains more overrules it.
  bool overruled_by_what_else_materials_do(const Studied& first, const Studied& current) {
    if (diagnosis_.effects.size() != 1 || study_.allowance(current) == Allowance::kept) {
      return false;
    }
    const std::string claimed = diagnosis_.effects.front();
    for (const std::string& id : of_materials(first.model)) {
      if (id == claimed) {
        continue;
      }
      options_.progress(fmt::format("fitting {} in the place of {}", id, claimed));
      Model model = first.model;
      model.effects.push_back(use_named(id));
      const Studied other = study_.settled(study_.refit(model, study_.executor()), Settle::roughly);
      if (other.fit.objective() < current.fit.objective() - kStandsBefore * kSolverDoubt) {
        diagnosis_.notes.push_back(fmt::format(
            "{} explains more than {} does, fitted to its end: nothing is claimed; `kolsky model "
            "add` it, fit, and diagnose again",
            id, claimed));
        drop_claims(diagnosis_);
        overruled_ = true;
        break;
      }
    }
    study_.residuals().anchor(current.composition, current.fit.theta,
                              ImpactResiduals::AnchorBy::middle);
    return overruled_;
  }

  /// Other readings of the law in three dimensions, without what was found: where one does as well,
  /// what was found is not more than a choice of reading.
  void weigh_readings(const Studied& first, const Studied& current) {
    const bool claims = !diagnosis_.effects.empty();
    const auto reading = reading_of(first.model);
    if (!reading || !(claims || current.misfit.repeatable_log_p < kUnexplained)) {
      return;
    }
    options_.progress("weighing the other readings of the law in three dimensions");
    const AnchoredAt at_first{first.composition, first_anchor_};
    const auto rival =
        best_rival_reading(study_, first.model, searched_, scale_, anchor_ ? &at_first : nullptr,
                           anchor_ ? &*anchor_ : nullptr);
    if (!rival || rival->behind > kStandsBefore) {
      return;
    }
    const std::string name = "reading " + rival->name + " of the law ";
    if (!claims) {
      diagnosis_.notes.push_back(name + "leaves less unexplained than " + *reading +
                                 ": choose it with `model new --reading`");
    } else if (rival->behind < -kStandsBefore) {
      diagnosis_.notes.push_back(
          name + "explains more than " + diagnosis_.effects.front() +
          " does: nothing is claimed; choose it with `model new --reading` and diagnose again");
      drop_claims(diagnosis_);
      overruled_ = true;
    } else {
      diagnosis_.tied_with[diagnosis_.effects.front()].emplace_back(kReadingEffect);
      diagnosis_.notes.push_back(name + "in place of " + *reading + " explains as much as " +
                                 diagnosis_.effects.front());
    }
  }

  void conclude(const Studied& first, const Studied& current) {
    diagnosis_.before = first.misfit;
    diagnosis_.after = current.misfit;
    diagnosis_.model = current.model;
    set_held_out(first, current);
    // What a ball lacks may have gone into the law's form, as far as that goes, or into materials.
    const double pressed = law_beyond_bounds(current);
    const FiledConflict filed = conflict_with_filed(current);
    const bool contradicts = filed.log_p < options_.log_alpha;
    const bool claims = !diagnosis_.effects.empty();
    std::vector<std::string> doubts;
    if (claims && pressed > kPressed) {
      doubts.push_back(law_pressed_note(pressed));
    }
    if (contradicts) {
      doubts.push_back(filed_note(filed, claims));
    }
    if (claims && leaves_too_much(first, current)) {
      doubts.push_back(left_of_claim_note(diagnosis_.held_out));
    }
    const std::optional<std::string> scatter = scatter_doubt(study_, current);
    if (scatter) {
      doubts.push_back(*scatter);
    }
    const std::optional<std::string> impulses = impulse_doubt(study_, current);
    if (impulses) {
      doubts.push_back(*impulses);
    }
    const bool left = remains(first, current);
    if (std::optional<std::string> rebounds =
            left ? rebound_doubt(study_, current) : std::nullopt) {
      doubts.push_back(*std::move(rebounds));
    }
    if (unbelievable_) {
      doubts.push_back(*unbelievable_);
    }
    const bool doubted =
        left || overruled_ || scatter || impulses || unbelievable_ || (claims && !doubts.empty());
    if (doubted || overruled_by_what_else_materials_do(first, current)) {
      give_up(diagnosis_, doubts, first.model, diagnosis_.held_out.floor);
    } else {
      settle_claims(diagnosis_,
                    [&](CandidateResult& result) { set_strength(current, result.effect, result); });
      add_notes(left_notes(study_, current, diagnosis_.held_out));
      add_notes(std::move(doubts));
    }
    if (diagnosis_.verdict == DiagnosisVerdict::adequate && (pressed > kPressed || contradicts)) {
      diagnosis_.verdict = DiagnosisVerdict::untestable;
    }
    for (const std::string& id : diagnosis_.effects) {
      if (std::vector<std::string> tied = diagnosis_.tied_with[id]; !tied.empty()) {
        tied.insert(tied.begin(), id);
        diagnosis_.next_experiment.push_back(next_impact(tied));
      }
    }
    for (const std::string& id : not_in_quiet_) {
      if (std::ranges::count(diagnosis_.effects, id) == 0) {
        set_verdict(diagnosis_, id, "rejected");
      }
    }
    add_notes(impact_notes(study_, current, diagnosis_.candidates, scale_, flat_));
  }

  /// Whether nothing will be said of what is missing, whatever a few more steps make of the fit:
  /// they have moved such logarithms of chances by a thirtieth.
  [[nodiscard]] bool surely_given_up(const Studied& first, const Studied& current) {
    constexpr double kSurely = 1.5;
    const bool contradicts = !diagnosis_.effects.empty() &&
                             conflict_with_filed(current).log_p < kSurely * options_.log_alpha;
    const bool left =
        remains(first, current) && diagnosis_.unexplained_log_p < kSurely * kUnexplained;
    return overruled_ || unbelievable_ || contradicts || left;
  }

  /// Whether misfit repeats that nothing explains.
  [[nodiscard]] bool remains(const Studied& first, const Studied& current) {
    const auto [chi2, freedom] = study_.repeated(current.fit.residual);
    const double explained = first.fit.objective() - current.fit.objective();
    diagnosis_.unexplained_log_p = study_.unexplained_log_p(current.fit.residual);
    return diagnosis_.unexplained_log_p < kUnexplained &&
           chi2 - freedom > kAllowedRest * std::max(0.0, explained);
  }

  /// What is missing closes the misfit of speeds that the fit did not see, as far as noise and the
  /// calculation leave it closed. What only resembles it closes a part, or nothing once it is
  /// settled, unless it is for what is filed that it is claimed.
  [[nodiscard]] bool leaves_too_much(const Studied& first, const Studied& current) const {
    constexpr double kPart = 0.5;
    constexpr double kMuch = 2.0;  // of noise alone: another code's coarse mesh leaves less
    const HeldOut& misfit = diagnosis_.held_out;
    const double closed = misfit.before - misfit.after;
    if (study_.allowance(current) != Allowance::kept) {
      const double shown = std::max(0.0, misfit.before - misfit.floor);
      return closed <= 0.0 || closed < kPart * shown ||
             (closed < (1.0 - kAllowedRest) * shown && misfit.after > kMuch * misfit.floor);
    }
    const double explained = first.fit.objective() - current.fit.objective();
    const bool of_filed = first.fit.penalty - current.fit.penalty > 0.5 * explained;
    return closed <= 0.0 && !of_filed;
  }

  void set_held_out(const Studied& before, const Studied& after) {
    const ImpactResiduals& residuals = study_.residuals();
    // Noise alone leaves what arrivals and offsets do not take up.
    const double left = 1.0 - residuals.eliminated() / static_cast<double>(residuals.per_shot());
    diagnosis_.held_out = {certifier_.held_out_misfit(before), certifier_.held_out_misfit(after),
                           left};
  }

  void add_notes(std::vector<std::string> lines) {
    std::ranges::move(lines, std::back_inserter(diagnosis_.notes));
  }

  /// The first model with the forces that it was fitted with, which are at hand.
  [[nodiscard]] ImpactComparison compared_at_first(const Studied& first) {
    study_.residuals().anchor(first.composition, first_anchor_);
    return study_.compare(first);
  }

  /// Every effect as the first search has it.
  void begin_table(const ImpactSearch& search, const std::vector<ImpactRefit>& refits) {
    diagnosis_.candidates = first_order_table({search.candidates(), search.directions(),
                                               search.base(), search.log_trials(), search.scale()});
    for (const FlatEffect& flat : search.flat()) {
      flat_.push_back(flat.id);
    }
    set_limits(search.flat(), search.scale(), diagnosis_.candidates);
    std::vector<std::string> all;
    for (const ImpactRefit& refit : refits) {
      all.push_back(search.candidate(refit).id());
    }
    note_refits(search, refits, all);
  }

  /// What a search found of these effects, in the place of what its row said before.
  void note_refits(const ImpactSearch& search, const std::vector<ImpactRefit>& refits,
                   const std::vector<std::string>& ids) {
    for (CandidateResult& result : diagnosis_.candidates) {
      const auto best = std::ranges::find_if(refits, [&](const ImpactRefit& refit) {
        return search.candidate(refit).id() == result.effect;
      });
      if (best == refits.end() || std::ranges::find(ids, result.effect) == ids.end()) {
        continue;
      }
      result.gain = best->gain;
      result.log_p = search.with_search(best->log_p);
      result.own_log_p = best->log_p;
      result.held_out_gain = certifier_.held_out_gain(search.base(), best->studied);
      result.refitted = true;
      set_strength(best->studied, result.effect, result);
    }
  }

  ImpactStudy& study_;
  const DiagnosisOptions& options_;
  ImpactCertifier certifier_;
  Diagnosis diagnosis_;
  double scale_ = kSolverDoubt;   ///< of the last search
  bool settled_roughly_ = false;  ///< the last model, as a search needs it
  double searched_ = 0.0;         ///< objective with what was added last, as the search had it
  std::vector<double> first_anchor_;
  std::optional<AnchoredAt> anchor_;  ///< where the fine forces were taken for what was added last
  bool overruled_ = false;            ///< by another reading of the law
  /// Of the last search what would be claimed if anybody believed it.
  std::optional<std::string> unbelievable_;
  std::set<std::string> not_in_quiet_;
  std::vector<std::string> flat_;  ///< without a slope at none
  struct Rest {
    std::string id;
    Studied studied;  ///< with it beside all that was found
  };
  /// What came nearest to a claim last, of what stands before nothing at all.
  std::optional<Rest> rest_;
};

}  // namespace

Diagnosis diagnose_impacts(ImpactStudy& study, const Model& model, const DiagnosisOptions& options,
                           ImpactsSeen* seen) {
  return Diagnostician(study, options).run(model, seen);
}

}  // namespace kolsky

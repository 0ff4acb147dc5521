#include "processing/criticism/impact/impact_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "processing/criticism/impact/impact_certifier.hpp"
#include "processing/criticism/impact/impact_search.hpp"
#include "processing/criticism/impact/impact_table.hpp"
#include "processing/criticism/impact/rival_readings.hpp"
#include "processing/criticism/verdict/claims.hpp"

namespace kolsky {

namespace {

constexpr double kWorthAllowing = 0.8;  ///< of the solver's usual share: less is not worth it

/// A number that every model here holds has no place to be taken from.
bool is_filed(const Studied& first, const std::string& id) {
  return first.model.find(id) != nullptr;
}

class Seeker {
 public:
  Seeker(ImpactStudy& study, const DiagnosisOptions& options)
      : study_(study), options_(options), certifier_(study, options.log_alpha) {}

  ImpactFindings run(const Model& model) {
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
      settled_ = Settle::roughly;
      search.emplace(study_, first);
    }
    searched_ = search->base().fit.objective();
    Studied current = first;
    while ((add_one(*search, current, Searched::settled) || add_two(current)) &&
           diagnosis_.effects.size() < options_.most_effects) {
      options_.progress("testing what remains after " + diagnosis_.effects.back());
      search.emplace(study_, current);
    }
    weigh_beside_others(first, current);
    weigh_beside_rest(first);
    weigh_readings(first, current);
    return {.first = std::move(first),
            .first_anchor = std::move(first_anchor_),
            .current = std::move(current),
            .settled = settled_,
            .diagnosis = std::move(diagnosis_),
            .scale = scale_,
            .overruled = overruled_,
            .unbelievable = std::move(unbelievable_),
            .not_in_quiet = std::move(not_in_quiet_),
            .flat = std::move(flat_)};
  }

 private:
  /// How far the model was fitted that was searched for what it lacks: a refit of a search goes by
  /// borrowed derivatives.
  enum class Searched { settled, as_refitted };

  bool add_one(ImpactSearch& search, Studied& current, Searched searched) {
    options_.progress("refitting rivals");
    search.refit_rivals();
    scale_ = search.scale();
    if (diagnosis_.candidates.empty()) {
      diagnosis_.candidates = table_of_impacts(search, certifier_);
      for (const FlatEffect& flat : search.flat()) {
        flat_.push_back(flat.id);
      }
    }
    const ImpactRefit* claimed = judge(search, search.base());
    unbelievable_ = certifier_.unbelievable(search, search.base());
    if (claimed == nullptr && searched == Searched::settled && diagnosis_.effects.empty() &&
        study_.allowance(current) != Allowance::kept) {
      options_.progress("fitting the nearest to a claim to their ends");
      search.settle_nearest(current);
      scale_ = search.scale();
      claimed = judge(search, current);
    }
    if (claimed == nullptr) {
      keep_rest(search);
      return false;
    }
    const std::string id = search.candidate(*claimed).id();
    diagnosis_.effects.push_back(id);
    diagnosis_.tied_with[id] = beside(search, *claimed);
    take(claimed->studied, current);
    return true;
  }

  /// A filed number that is set free has its place in every model already.
  void keep_rest(const ImpactSearch& search) {
    const std::vector<ImpactRefit>& refits = search.refits();
    rest_.reset();
    if (!refits.empty() && refits.front().evidence > kStandsBefore &&
        !search.candidate(refits.front()).frees_prior) {
      rest_ = Rest{search.candidate(refits.front()).id(), refits.front().studied};
    }
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
    if (!add_one(search, beside, Searched::as_refitted)) {
      rest_ = nearest;
      unbelievable_ = unbelievable;
      return false;
    }
    diagnosis_.effects.insert(diagnosis_.effects.begin() + static_cast<std::ptrdiff_t>(place),
                              nearest.id);
    current = std::move(beside);
    return true;
  }

  /// Puts down what becomes of the refits. @return the one that is certified; none: null
  const ImpactRefit* judge(const ImpactSearch& search, const Studied& base) {
    note_not_in_quiet(search);
    const JudgedRefits judged = certifier_.judged(search, base);
    for (const std::string& id : judged.rejected) {
      set_verdict(diagnosis_, id, CandidateVerdict::rejected);
    }
    std::vector<std::string> told = judged.rejected;
    if (judged.certified != nullptr) {
      told.push_back(search.candidate(*judged.certified).id());
      std::ranges::copy(beside(search, *judged.certified), std::back_inserter(told));
    }
    note_refits(search, told, certifier_, diagnosis_.candidates);
    return judged.certified;
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
    settled_ = Settle::roughly;
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
    search.refit_rivals(id, current);
    const ImpactRefit* claimed = judge(search, search.base());
    if (claimed == nullptr) {
      drop_claim(diagnosis_, id, CandidateVerdict::rejected);
      take(others, current);
      return true;
    }
    const std::string now = search.candidate(*claimed).id();
    std::replace(diagnosis_.effects.begin(), diagnosis_.effects.end(), id, now);
    diagnosis_.tied_with.erase(id);
    diagnosis_.tied_with[now] = beside(search, *claimed);
    if (now == id) {
      return false;
    }
    set_verdict(diagnosis_, id, CandidateVerdict::rejected);
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
      search.refit_rivals(id, rest_->studied);
      const auto own = std::ranges::find_if(search.refits(), [&](const ImpactRefit& refit) {
        return search.candidate(refit).id() == id;
      });
      if (own == search.refits().end()) {
        continue;
      }
      std::vector<std::string>& ties = diagnosis_.tied_with[id];
      for (const std::string& other : beside(search, *own)) {
        if (std::ranges::find(ties, other) == ties.end()) {
          ties.push_back(other);
        }
      }
    }
    diagnosis_.notes.push_back(
        "what is claimed leaves something that is not certified; nearest is " + rest_->id);
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
    const bool stands_before = rival->behind < -kStandsBefore;
    if (!claims) {
      if (stands_before) {
        diagnosis_.notes.push_back(name + "leaves less unexplained than " + *reading +
                                   ": choose it with `model new --reading`");
      }
    } else if (stands_before) {
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

  ImpactStudy& study_;
  const DiagnosisOptions& options_;
  ImpactCertifier certifier_;
  Diagnosis diagnosis_;
  double scale_ = kSolverDoubt;     ///< of the last search
  Settle settled_ = Settle::fully;  ///< the last model: roughly is as far as a search needs it
  double searched_ = 0.0;           ///< objective with what was added last, as the search had it
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

ImpactFindings find_what_impacts_lack(ImpactStudy& study, const Model& model,
                                      const DiagnosisOptions& options) {
  return Seeker(study, options).run(model);
}

}  // namespace kolsky

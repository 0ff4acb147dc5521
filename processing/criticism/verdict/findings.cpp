#include "processing/criticism/verdict/findings.hpp"

#include <algorithm>

#include "processing/criticism/fitting/astray.hpp"
#include "processing/criticism/search/search.hpp"
#include "processing/criticism/verdict/choice.hpp"
#include "processing/criticism/verdict/claims.hpp"
#include "processing/criticism/verdict/complement.hpp"
#include "processing/criticism/verdict/disbelief.hpp"
#include "processing/criticism/verdict/going_back.hpp"
#include "processing/criticism/verdict/parting.hpp"
#include "processing/criticism/verdict/refits.hpp"

namespace kolsky {

namespace {

class Seeker {
 public:
  Seeker(Study& study, const DiagnosisOptions& options, const std::vector<std::string>& barred,
         Trail& trail, Findings& found)
      : study_(study), options_(options), barred_(barred), trail_(trail), found_(found) {}

  void run() {
    const bool settled = seek();
    found_.first = let_out_.value_or(found_.first);
    if (found_.trodden) {
      return;
    }
    if (claims().size() == 1 && any_beyond_belief()) {
      // Nothing was found beside it that takes its part.
      const std::string id = claims().front();
      drop(found_, id, CandidateVerdict::rejected, without(study_, found_.current, id));
    }
    if (options_.safeguards.backward && claims().size() > 1 && !settled) {
      go_back(study_, options_, found_);
    }
    if (found_.on_trial && std::ranges::count(claims(), *found_.on_trial) > 0) {
      // Nothing found beside it makes the shots agree on it.
      drop_claims(found_.diagnosis);
      found_.current = study_.refit(found_.first);
    }
  }

 private:
  [[nodiscard]] const std::vector<std::string>& claims() const { return found_.diagnosis.effects; }
  [[nodiscard]] bool two_beside_the_bar() const { return beside_the_bar(claims()).size() == 2; }

  /// Two are sought again beside each other before a third is: that may explain no more than what
  /// the first of them was chosen wrongly for.
  /// @return that nothing was added to two that stand beside each other
  bool seek() {
    bool gone_back = false;
    while (surprises(claims(), found_.current.model).size() < options_.most_effects) {
      prefer_complement();
      const bool two = two_beside_the_bar();
      if (two && !gone_back && options_.safeguards.backward) {
        go_back(study_, options_, found_);
        gone_back = true;
        found_.beginning.far_off = leaves_most();
        found_.trodden = two_beside_the_bar() && !trail_.pairs.insert(pair_here()).second;
        if (found_.trodden || found_.beginning.far_off) {
          return true;
        }
      }
      if (!add_one()) {
        return two && gone_back && two_beside_the_bar();
      }
    }
    return false;
  }

  /// One by one, what was found at half of the gauges does not come to be at the others.
  void prefer_complement() {
    std::optional<Complement> complement =
        options_.safeguards.backward ? complement_of(study_, found_) : std::nullopt;
    if (complement && complement->ahead()) {
      take_place(study_, options_, *std::move(complement), found_);
    }
  }

  [[nodiscard]] Trail::Pair pair_here() const {
    return {{claims().begin(), claims().end()}, found_.on_trial.value_or("")};
  }

  /// Whether two that stand beside each other leave more of what repeats than they explain: no
  /// third and no other beginning explains what nothing in the library is near to, and a search is
  /// long.
  [[nodiscard]] bool leaves_most() const {
    if (beside_the_bar(claims()).size() < 2) {
      return false;
    }
    const Studied& current = found_.current;
    const double noise = noise_of(current.misfit, study_.campaign().shots.size());
    // In the noise that is frozen, which is that of what was found.
    const Studied before = changed(study_, found_.first, found_.first.model);
    const double explained = (before.fit.objective() - current.fit.objective()) / noise;
    return explained < repeated_excess(study_, current);
  }

  /// @return whether there was one
  bool add_one() {
    options_.progress(claims().empty() ? "testing every effect of the library"
                                       : "testing what remains after " + claims().back());
    Search search(study_, found_.current, found_.start, options_.safeguards);
    Diagnosis& diagnosis = found_.diagnosis;
    const bool first = diagnosis.effects.empty();
    if (diagnosis.candidates.empty()) {
      diagnosis.candidates = first_order_table({search.candidates(), search.directions(),
                                                found_.current, search.log_trials(), 1.0,
                                                search.known(), study_.residuals().per_shot()});
    }
    Chooser chooser(study_, options_, diagnosis);
    std::optional<Choice> choice = first ? chooser.choose_first(search, found_.current, barred_)
                                         : chooser.choose_next(search, found_.current);
    if (first) {
      found_.parting = parting_in_place_of(study_, found_.current, found_.start,
                                           choice ? choice->studied : found_.current);
    }
    if (!choice || found_.parting) {
      return false;
    }
    if (first) {
      found_.beginning.effect = choice->id;
      found_.beginning.lead_over_next = choice->lead_over_next;
    }
    if (choice->on_trial) {
      found_.on_trial = choice->id;
    }
    diagnosis.effects.push_back(choice->id);
    found_.start = with(found_.start, search.candidates()[choice->candidate], Auxiliaries::free);
    go_on_with(study_, options_, *choice, found_);
    return !first || let_out_ || !came_back_from_astray() || add_one();
  }

  /// A fit that has gone astray gains by whatever lets it out, and keeps the gain without it: then
  /// nothing was found, and the search begins from where the fit is now.
  bool came_back_from_astray() {
    if (!options_.safeguards.backward) {
      return false;
    }
    const std::string id = claims().front();
    Studied left = without(study_, found_.current, id);
    if (missed_in(study_, left, found_.current)) {
      return false;
    }
    drop(found_, id, CandidateVerdict::not_needed, std::move(left));
    found_.diagnosis.candidates.clear();
    found_.on_trial.reset();
    found_.beginning.lead_over_next.reset();
    let_out_ = found_.current;
    return true;
  }

  /// Beside what was found later, what was found first may have grown out of all bounds.
  [[nodiscard]] bool any_beyond_belief() const {
    return std::ranges::any_of(claims(), [&](const std::string& id) {
      return beyond_belief(found_.current, id, study_.campaign(), 1.0);
    });
  }

  Study& study_;
  const DiagnosisOptions& options_;
  const std::vector<std::string>& barred_;
  Trail& trail_;
  Findings& found_;
  std::optional<Studied> let_out_;  ///< the model, where its first fit had gone astray
};

}  // namespace

void drop(Findings& found, const std::string& id, CandidateVerdict verdict, Studied left) {
  found.current = std::move(left);
  std::erase_if(found.start.effects, [&](const EffectUse& use) { return use.id() == id; });
  drop_claim(found.diagnosis, id, verdict);
}

Findings find_what_lacks(Study& study, const Model& model, const DiagnosisOptions& options,
                         const std::vector<std::string>& barred, Trail& trail) {
  options.progress("fitting the model");
  const Studied first =
      study.fit(model, options.safeguards.fitted_noise ? LearnNoise::yes : LearnNoise::no);
  Findings found{.first = first, .current = first, .start = begun_afresh(model).value_or(model)};
  found.diagnosis.before = first.misfit;
  Seeker(study, options, barred, trail, found).run();
  return found;
}

}  // namespace kolsky

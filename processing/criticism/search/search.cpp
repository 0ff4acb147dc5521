#include "processing/criticism/search/search.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/admission.hpp"
#include "processing/criticism/search/search_trials.hpp"
#include "processing/criticism/search/shortlist.hpp"
#include "processing/criticism/search/shot_strengths.hpp"

namespace kolsky {

Search::Search(Study& study, const Studied& base, const Model& start, const Safeguards& safeguards)
    : ground_(study, base),
      safeguards_(safeguards),
      refitter_(ground_, start),
      slow_chances_(ground_),
      rating_(ground_, safeguards.search_count
                           ? independent_trials(base, ground_.candidates, ground_.directions)
                           : 1.0) {}

std::vector<double> Search::known() const {
  std::vector<double> list;
  for (const Candidate& candidate : ground_.candidates) {
    list.push_back(rating_.known_of(candidate.use));
  }
  return list;
}

std::vector<Refit> Search::refit_rivals() {
  const std::vector<std::size_t> chosen =
      worth_refitting(ground_, safeguards_.own_strengths ? &slow_chances_ : nullptr);
  std::vector<std::optional<Refit>> done(chosen.size());
  ground_.study.executor().run(chosen.size(), [&](std::size_t i, std::size_t worker) {
    done[i] = refitter_.refit(chosen[i], worker);
  });
  std::vector<Refit> list;
  for (auto& own : done) {
    if (admit(*own)) {
      list.push_back(*std::move(own));
    } else {
      dismiss(*own);
    }
  }
  rating_.rate_in_order(list);
  refine(list);
  if (safeguards_.slow_noise) {
    rating_.weigh_beside_slow_noise(list);
  }
  rating_.weigh_by_pulses(list);
  rating_.weigh_beside_rounding(list);
  return list;
}

bool Search::admit(Refit& refit) {
  return explains(refit, ground_) &&
         (!safeguards_.own_strengths || confirm_own_strengths(refit, ground_, slow_chances_));
}

void Search::dismiss(const Refit& refit) {
  const EffectUse& use = ground_.candidates[refit.candidate].use;
  const double gain = gain_over_own_noise(refit, ground_);
  const double noise = noise_of(refit.studied.misfit, ground_.study.campaign().shots.size());
  const double chance =
      rating_.beside_rounding(log_gain_tail(gain, refit.freedom, Signs::both), refit, noise);
  Dismissed& own = dismissed_[use.id()];
  own.verdict = use.per_shot ? CandidateVerdict::unconfirmed : CandidateVerdict::rejected;
  own.gain = std::max(own.gain, gain);
  own.chance = std::min(own.chance, chance);
  if (use.per_shot && is_addition(*use.effect) && fits_the_signal(refit, ground_.base)) {
    rating_.note_unconfirmed(refit, gain, equivalent_square(chance));
  }
}

/// What stands near the best is fitted with derivatives of its own.
void Search::refine(std::vector<Refit>& list) {
  constexpr double kNear = 30.0;  // as a square of a normal deviate
  constexpr double kShare = 0.05;
  const auto near = [&](const Refit& own) {
    const double best = list.front().evidence;
    return own.rough && own.evidence > best - std::max(kNear, kShare * best);
  };
  while (true) {
    std::vector<std::size_t> at;
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (near(list[i])) {
        at.push_back(i);
      }
    }
    if (at.empty()) {
      return;
    }
    ground_.study.executor().run(at.size(), [&](std::size_t i, std::size_t worker) {
      Refit& own = list[at[i]];
      own = refitter_.refit_closely(std::move(own), worker);
    });
    std::erase_if(list, [&](Refit& own) {
      if (admit(own)) {
        return false;
      }
      dismiss(own);
      return true;
    });
    rating_.rate_in_order(list);
  }
}

}  // namespace kolsky

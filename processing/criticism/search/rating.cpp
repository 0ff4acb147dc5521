#include "processing/criticism/search/rating.hpp"

#include <algorithm>
#include <cmath>

#include "processing/criticism/fitting/share_of_pulses.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/beside.hpp"
#include "processing/criticism/search/beside_rounding.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/search/slow_weights.hpp"

namespace kolsky {

namespace {

/// Chances (ln) that need no second look.
constexpr double kOrdinary = -3.0;

}  // namespace

double gain_over_own_noise(const Refit& refit, const SearchGround& ground) {
  const double noise = noise_of(refit.studied.misfit, ground.study.campaign().shots.size());
  return (ground.base.fit.objective() - refit.studied.fit.objective()) / noise;
}

double Rating::with_search(double log_p) const {
  return std::min(0.0, log_p + std::log(trials_));
}

double Rating::without_search(const Refit& refit) const {
  return refit.products || refit.slow ? with_search(refit.log_p) : refit.log_p;
}

double Rating::log_trials() const {
  return std::log(trials_);
}

double Rating::known_of(const EffectUse& use) const {
  const std::size_t shots = ground_.study.campaign().shots.size();
  const double believed = belief_in(*use.effect, ground_.study.residuals().noise(), shots);
  return use.per_shot ? believed : believed + static_cast<double>(shots - 1);
}

void Rating::rate_in_order(std::vector<Refit>& list) const {
  const auto best = std::min_element(list.begin(), list.end(), [](const Refit& a, const Refit& b) {
    return a.studied.fit.objective() < b.studied.fit.objective();
  });
  if (best == list.end()) {
    return;
  }
  const double noise = noise_of(best->studied.misfit, ground_.study.campaign().shots.size());
  for (Refit& refit : list) {
    rate(refit, noise);
  }
  std::sort(list.begin(), list.end(),
            [](const Refit& a, const Refit& b) { return a.evidence > b.evidence; });
}

void Rating::rate(Refit& refit, double noise) const {
  double over_noise = (ground_.base.fit.objective() - refit.studied.fit.objective()) / noise;
  refit.beside = share_beside_unconfirmed(
      refit, equivalent_square(log_gain_tail(over_noise, refit.freedom, refit.signs)));
  over_noise *= refit.beside;
  refit.noise = noise;
  refit.over_noise = over_noise;
  refit.gain = over_noise / refit.scatter;
  refit.log_p = chance_of(refit, refit.gain);
  // The shots' scatter tells how well a gain is known, and only roughly: divided by one rival's
  // own, what fits best would come behind what fits worse. But slow noise gives additions more
  // than their rivals.
  const EffectUse& use = candidate_of(refit).use;
  const bool addition = is_addition(*use.effect);
  refit.doubt = addition ? 1.0 : refit.scatter;
  // Additions are weighed by what their shots scatter already.
  refit.known = addition ? kKnownWell : std::min(kKnownWell, known_of(use));
  refit.rival_log_p = addition ? refit.log_p : chance_of(refit, over_noise);
  refit.evidence = equivalent_square(
      log_gain_tail(addition ? refit.gain : over_noise, refit.freedom, refit.signs));
  if (refit.products) {
    // What differs between the shots may have been taken for noise: then its gain says too little.
    refit.evidence = std::max(refit.evidence, equivalent_square(refit.log_p));
  }
  if (refit.slow) {
    // The noise that it is weighed by holds it: what remains without tells more. A rival it meets
    // by itself.
    refit.evidence = equivalent_square(refit.slow->alone);
  }
}

/// ln of the chance of a gain on noise as a refit's, whose power in its direction the shots tell no
/// better than so many degrees of freedom do.
double Rating::chance_of(const Refit& refit, double gain) const {
  const EffectUse& use = candidate_of(refit).use;
  if (refit.products) {
    // Nothing else is judged by products: what has been sought among is the effect's own variants.
    const auto variants = std::count_if(
        ground_.candidates.begin(), ground_.candidates.end(),
        [&](const auto& c) { return c.id() == use.id() && c.use.per_shot && !c.use.alike; });
    const double chance = refit.products->log_p + std::log(static_cast<double>(variants));
    return std::min(chance, refit.slow ? refit.slow->least() : 0.0) - std::log(trials_);
  }
  if (refit.slow) {
    return refit.slow->least() - std::log(trials_);
  }
  if (use.per_shot || gain <= 0.0) {
    return log_gain_tail(gain, refit.freedom, refit.signs);
  }
  const double freedom = std::max(refit.freedom, 1.0);
  const double log_p = log_f_tail(gain / freedom, freedom, known_of(use));
  return refit.signs == Signs::one ? log_p - std::log(2.0) : log_p;
}

/// What explains less than something slow that nothing confirms must do so beside it, too: else it
/// may be only the part of it that comes again in every shot.
double Rating::share_beside_unconfirmed(const Refit& refit, double evidence) const {
  if (!unconfirmed_ || evidence > unconfirmed_->evidence || candidate_of(refit).use.per_shot ||
      candidate_of(refit).id() == ground_.candidates[unconfirmed_->candidate].id() ||
      is_most_of_unconfirmed(refit, evidence)) {
    return 1.0;
  }
  return share_beside(ground_.directions[refit.candidate],
                      ground_.candidates[unconfirmed_->candidate],
                      ground_.directions[unconfirmed_->candidate], ground_.base.fit.covariance);
}

/// Where an addition is most of the slow thing, this stands in for it: what slopes by chance in
/// every shot as it likes, the scatter of the shots' own slopes tells from that.
bool Rating::is_most_of_unconfirmed(const Refit& refit, double evidence) const {
  if (!is_addition(*candidate_of(refit).use.effect)) {
    return false;
  }
  const double rest = std::max(0.0, unconfirmed_->gain - gain_over_own_noise(refit, ground_));
  const double freedom = std::max(1.0, unconfirmed_->freedom - refit.freedom);
  return evidence > equivalent_square(log_gain_tail(rest, freedom, Signs::both));
}

void Rating::note_unconfirmed(const Refit& refit, double gain, double evidence) {
  if (!unconfirmed_ || evidence > unconfirmed_->evidence) {
    unconfirmed_ = {refit.candidate, evidence, gain, refit.freedom};
  }
}

/// How many times ln of a chance is what it would be if coarse converters left noise.
double Rating::times_by_rounding(const Refit& refit, double noise) const {
  if (ground_.far_off() || refit.products || refit.slow) {
    return 1.0;
  }
  if (!drawn_) {
    // Alike in all shots they would leave as much in each, and hide what is far above them.
    drawn_ = drawn_rounding_and_noise(ground_.study, ground_.base, StepsLie::as_each_shot_has_them);
  }
  Exaggerated chances;
  if (drawn_->cols() > 0) {
    for (const double gain : gains_by_chance(refit.studied, candidate_of(refit).id(), *drawn_)) {
      chances.add(chance_of(refit, gain / noise / refit.scatter));
    }
  }
  return chances.times();
}

double Rating::beside_rounding(double log_p, const Refit& refit, double noise) const {
  return with_search(log_p) <= kOrdinary ? log_p / times_by_rounding(refit, noise) : log_p;
}

void Rating::weigh_beside_rounding(std::vector<Refit>& list) const {
  for (Refit& refit : list) {
    refit.log_p = beside_rounding(refit.log_p, refit, refit.noise);
    refit.rival_log_p = beside_rounding(refit.rival_log_p, refit, refit.noise);
  }
}

void Rating::weigh_by_pulses(std::vector<Refit>& list) const {
  WhiteResiduals& residuals = ground_.study.residuals();
  const auto pulses_of = [&](const Studied& own, std::size_t worker) {
    return residuals.only_carries(own.composition, own.fit.theta)
               ? residuals.whiten_pulses(own.composition, own.fit.theta, worker)
               : Eigen::VectorXd();
  };
  std::vector<Refit*> weighed;
  for (Refit& refit : list) {
    if (with_search(refit.log_p) <= kOrdinary) {
      weighed.push_back(&refit);
    }
  }
  if (ground_.far_off() || weighed.empty()) {
    return;
  }
  const Workers& executor = ground_.study.executor();
  const Eigen::VectorXd without = pulses_of(ground_.base, executor.first);
  executor.run(weighed.size(), [&](std::size_t i, std::size_t worker) {
    Refit& refit = *weighed[i];
    refit.pulses = pulses_of(refit.studied, worker);
    const double share = share_of_pulses({ground_.base.fit.residual, without},
                                         {refit.studied.fit.residual, refit.pulses});
    refit.log_p = std::max(refit.log_p, chance_of(refit, share * refit.gain));
  });
}

void Rating::weigh_beside_slow_noise(std::vector<Refit>& list) const {
  const auto weighed = [&](const Refit& refit) {
    return with_search(refit.log_p) <= kOrdinary && !is_addition(*candidate_of(refit).use.effect);
  };
  if (ground_.far_off() || std::ranges::none_of(list, weighed)) {
    return;
  }
  const std::size_t per_shot = ground_.study.residuals().per_shot();
  for (const SlowWeights& slow : slow_weights(ground_.study, ground_.base)) {
    const double without = slow.refitted(ground_.base, per_shot).fit.objective();
    for (Refit& refit : list) {
      if (weighed(refit)) {
        const Studied with = slow.refitted(refit.studied, per_shot);
        const double scatter = scatter_over_noise(with, candidate_of(refit).id(), per_shot);
        const double gain = (without - with.fit.objective()) / refit.noise / scatter;
        refit.log_p = std::max(refit.log_p, chance_of(refit, gain));
      }
    }
  }
}

}  // namespace kolsky

#include "processing/criticism/search/search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "processing/criticism/fitting/astray.hpp"
#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/in_noise_of.hpp"
#include "processing/criticism/fitting/moduli_starts.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/beside.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/search_trials.hpp"
#include "processing/criticism/search/shot_strengths.hpp"
#include "processing/criticism/search/slow_weights.hpp"
#include "processing/models/formula_strength.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostRefits = 14;
constexpr std::size_t kAlwaysRefits = 8;  ///< however far behind the first at first order
constexpr double kWorthRefitting = 12.0;  ///< as a square of a normal deviate
/// So much more must a harmonic explain than the mains' own frequency, which hums most: in a record
/// much shorter than a period all frequencies look alike, with amplitudes in inverse proportion.
constexpr double kHarmonic = 9.0;

/// Of the mains, and no frequency that the mains have anywhere.
bool is_harmonic(const EffectUse& use) {
  const auto& parameters = use.effect->about().parameters;
  constexpr double kMainsAtMost_Hz = 65.0;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].chosen && parameters[p].unit == "Hz") {
      return use.values[p].value > kMainsAtMost_Hz;
    }
  }
  return false;
}

/// Two sensor effects of one gauge.
bool at_one_gauge(const Candidate& a, const Candidate& b) {
  return !a.use.gauge.empty() && a.use.gauge == b.use.gauge && !a.frees_prior &&
         a.use.effect->about().stage == Stage::sensor;
}

/// The material's effects take each other's places at a finite size: what a dashpot does, the
/// material's own branch and a further one can do together.
/// The same hum but for its frequency, neither a harmonic.
bool is_other_mains(const Candidate& one, const Candidate& other) {
  const EffectUse& a = one.use;
  const EffectUse& b = other.use;
  return a.effect->about().quadrature && a.id() == b.id() && a.per_shot == b.per_shot &&
         a.alike == b.alike && !is_harmonic(a) && !is_harmonic(b);
}

bool is_switch(const Candidate& candidate) {
  const auto& parameters = candidate.use.effect->about().parameters;
  return std::any_of(parameters.begin(), parameters.end(),
                     [](const EffectParameter& parameter) { return parameter.is_switch; });
}

/// Where it is small it does nothing.
bool is_sudden(const Candidate& candidate) {
  return candidate.use.effect->about().parameters.front().sudden;
}

/// What shots have of their own in the records, alike at all gauges or at one: as many numbers at
/// every gauge would be judged by their products.
bool may_be_slow_noise(const Candidate& candidate) {
  const EffectUse& use = candidate.use;
  return use.per_shot && is_addition(*use.effect) && (use.alike || !use.effect->about().each_gauge);
}

/// A hum in shares of each gauge's own, which is judged by its products.
bool has_shares(const Candidate& candidate) {
  const EffectUse& use = candidate.use;
  return use.per_shot && use.effect->about().quadrature && !use.alike;
}

void better_of(ModelFit& fit, ModelFit other) {
  if (other.objective() < fit.objective()) {
    fit = std::move(other);
  }
}

bool of_material(const Candidate& candidate) {
  return candidate.use.effect->about().stage == Stage::material;
}

}  // namespace

double lead(const Refit& ahead, const Refit& behind) {
  const double apart = (ahead.evidence - behind.evidence) / std::max(ahead.doubt, behind.doubt);
  return square_on_noise(apart, std::min(ahead.known, behind.known));
}

Search::Search(Study& study, const Studied& base, const Model& start, const Safeguards& safeguards)
    : study_(study),
      base_(base),
      safeguards_(safeguards),
      candidates_(candidates_for(base, study.campaign())),
      directions_(candidates_.size()),
      afresh_(start) {
  study.executor().run(candidates_.size(), [&](std::size_t i, std::size_t worker) {
    directions_[i] = direction_of(candidates_[i], base_, study_, worker);
  });
  may_be_astray_ = astray(base_.model, base_.misfit);
  if (may_be_astray_ ||
      std::ranges::any_of(candidates_, [&](const Candidate& own) { return begins_afresh(own); })) {
    start_moduli(afresh_, study.campaign(), study.residuals());
  }
  if (safeguards_.search_count) {
    trials_ = independent_trials(base_, candidates_, directions_);
  }
}

bool Search::far_off() const {
  return base_.misfit.chi2_reduced > kFarOff;
}

double Search::with_search(double log_p) const {
  return std::min(0.0, log_p + std::log(trials_));
}

double Search::without_search(const Refit& refit) const {
  return refit.products || refit.slow ? with_search(refit.log_p) : refit.log_p;
}

double Search::log_trials() const {
  return std::log(trials_);
}

std::vector<double> Search::known() const {
  std::vector<double> list;
  for (const Candidate& candidate : candidates_) {
    list.push_back(known_of(candidate.use));
  }
  return list;
}

/// Degrees of freedom by which noise is known in an effect's direction: what differs between the
/// shots tells of it too, unless each shot has a strength of its own.
double Search::known_of(const EffectUse& use) const {
  const std::size_t shots = study_.campaign().shots.size();
  const double believed = belief_in(*use.effect, study_.residuals().noise(), shots);
  return use.per_shot ? believed : believed + static_cast<double>(shots - 1);
}

std::vector<Refit> Search::refits() {
  const std::vector<std::size_t> chosen = worth_refitting();
  std::vector<std::optional<Refit>> done(chosen.size());
  study_.executor().run(chosen.size(), [&](std::size_t i, std::size_t worker) {
    done[i] = refit(chosen[i], worker);
  });
  std::vector<Refit> list;
  for (auto& own : done) {
    if (own && admissible(*own)) {
      list.push_back(std::move(*own));
    } else if (own) {
      dismiss(*own);
    }
  }
  rate_in_order(list);
  refine(list);
  weigh_beside_slow_noise(list);
  return list;
}

/// What would be named must gain as much where slow noise counts no more than it tells. Additions
/// are judged by that noise already.
void Search::weigh_beside_slow_noise(std::vector<Refit>& list) const {
  constexpr double kOrdinary = -3.0;
  const auto weighed = [&](const Refit& refit) {
    return with_search(refit.log_p) <= kOrdinary &&
           !is_addition(*candidates_[refit.candidate].use.effect);
  };
  if (!safeguards_.slow_noise || far_off() || std::ranges::none_of(list, weighed)) {
    return;
  }
  const std::size_t per_shot = study_.residuals().per_shot();
  for (const SlowWeights& slow : slow_weights(study_, base_)) {
    const double without = slow.refitted(base_, per_shot).fit.objective();
    for (Refit& refit : list) {
      if (weighed(refit)) {
        const Studied with = slow.refitted(refit.studied, per_shot);
        const double scatter =
            scatter_over_noise(with, candidates_[refit.candidate].id(), per_shot);
        const double gain = (without - with.fit.objective()) / refit.noise / scatter;
        refit.log_p = std::max(refit.log_p, chance_of(refit, gain));
      }
    }
  }
}

/// A strength that is less than its own deviation is none, whatever fits better with it. (That of a
/// relaxation is as uncertain where its time is near the material's own: see beyond_the_record.)
bool Search::stands_out(const Refit& refit) const {
  const Candidate& candidate = candidates_[refit.candidate];
  const EffectUse* use = refit.studied.model.find(candidate.id());
  const auto& parameters = candidate.use.effect->about().parameters;
  const auto moving =
      std::ranges::count_if(parameters, [](const EffectParameter& own) { return !own.chosen; });
  if (use == nullptr || use->per_shot || candidate.frees_prior || moving != 1 ||
      parameters.front().is_switch) {
    return true;
  }
  const ModelValue& own = use->values.front();
  return std::abs(own.value - parameters.front().null_value) >= own.sd;
}

bool Search::admissible(Refit& refit) {
  return std::isfinite(refit.studied.fit.objective()) && !beyond_the_record(refit.studied, refit) &&
         stands_out(refit) && fits_the_signal(refit) &&
         allowed_by_formula(*refit.studied.model.find(candidates_[refit.candidate].id())) &&
         (!safeguards_.own_strengths || confirmed(refit));
}

bool Search::confirmed(Refit& refit) {
  const std::string id = candidates_[refit.candidate].id();
  const auto by_itself = [&](Claim claim) {
    return own_strengths_confirmed(refit.studied, id, study_.campaign(), claim);
  };
  // By products first: slow noise takes longer to ask.
  if (refit.products && by_itself(Claim::fresh)) {
    return true;
  }
  if (refit.products && !by_itself(Claim::beyond_slow_noise)) {
    return false;
  }
  const SlowChance chance = slow_chance(refit.candidate);
  if (slow_noise_excluded(chance.least(), Claim::fresh)) {
    refit.slow = chance;
    return true;
  }
  return !refit.products && by_itself(Claim::fresh);
}

/// ln of the chances of the best of all additions of each shot's own on slow noise.
SlowChance Search::slow_chance(std::size_t index) {
  const Candidate& candidate = candidates_[index];
  const Direction& direction = directions_[index];
  // Far from the records, what repeats is most of what slow noise would be.
  if (!(may_be_slow_noise(candidate) || has_shares(candidate)) || direction.freedom < 1.0 ||
      far_off()) {
    return {};
  }
  if (const auto known = slow_chances_.find(index); known != slow_chances_.end()) {
    return known->second;
  }
  if (!slow_noise_) {
    slow_noise_.emplace(base_, study_);
  }
  std::set<std::string> kinds;
  for (const Candidate& other : candidates_) {
    if (may_be_slow_noise(other)) {
      kinds.insert(other.id());
    }
  }
  const double among = std::log(2.0 * static_cast<double>(kinds.size()));
  const SlowNoise::Addition own{candidate, direction};
  SlowChance chance{slow_noise_->log_chance({&own, 1}) + among};
  std::vector<SlowNoise::Addition> others = at_other_gauges(candidate);
  if (!slow_noise_excluded(chance.alone, Claim::fresh) && !others.empty()) {
    const double beside = slow_noise_->log_chance_beside(own, others);
    others.push_back(own);
    chance.with_others = std::max(beside, slow_noise_->log_chance(others)) + among;
  }
  slow_chances_.emplace(index, chance);
  return chance;
}

/// The same addition at other gauges.
std::vector<SlowNoise::Addition> Search::at_other_gauges(const Candidate& own) const {
  std::vector<SlowNoise::Addition> list;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const EffectUse& use = candidates_[i].use;
    if (use.effect == own.use.effect && use.gauge != own.use.gauge &&
        may_be_slow_noise(candidates_[i]) && directions_[i].freedom >= 1.0) {
      list.push_back({candidates_[i], directions_[i]});
    }
  }
  return list;
}

void Search::dismiss(const Refit& refit) {
  const EffectUse& use = candidates_[refit.candidate].use;
  const double noise = noise_of(refit.studied.misfit, study_.campaign().shots.size());
  const double gain = (base_.fit.objective() - refit.studied.fit.objective()) / noise;
  const double chance = log_gain_tail(gain, refit.freedom, false);
  Dismissed& own = dismissed_[use.id()];
  own.verdict = use.per_shot ? "unconfirmed" : "rejected";
  own.gain = std::max(own.gain, gain);
  own.chance = std::min(own.chance, chance);
  if (!use.per_shot || !is_addition(*use.effect) || !fits_the_signal(refit)) {
    return;
  }
  const double evidence = equivalent_square(chance);
  if (!unconfirmed_ || evidence > unconfirmed_->evidence) {
    unconfirmed_ = {refit.candidate, evidence, gain, refit.freedom};
  }
}

/// What explains less than something slow that nothing confirms must do so beside it, too: else it
/// may be only the part of it that comes again in every shot. But where an addition that does is
/// most of it, it is the slow thing that stands in for the addition: what slopes by chance in every
/// shot as it likes, the scatter of the shots' own slopes tells from that.
double Search::share_beside_unconfirmed(const Refit& refit, double evidence) const {
  const Candidate& own = candidates_[refit.candidate];
  const auto is_most_of_it = [&] {
    const double noise = noise_of(refit.studied.misfit, study_.campaign().shots.size());
    const double gain = (base_.fit.objective() - refit.studied.fit.objective()) / noise;
    const double rest = std::max(0.0, unconfirmed_->gain - gain);
    const double freedom = std::max(1.0, unconfirmed_->freedom - refit.freedom);
    return is_addition(*own.use.effect) &&
           evidence > equivalent_square(log_gain_tail(rest, freedom, false));
  };
  if (!unconfirmed_ || evidence > unconfirmed_->evidence || own.use.per_shot ||
      own.id() == candidates_[unconfirmed_->candidate].id() || is_most_of_it()) {
    return 1.0;
  }
  return share_beside(directions_[refit.candidate], candidates_[unconfirmed_->candidate],
                      directions_[unconfirmed_->candidate], base_.fit.covariance);
}

/// What fits better for counting more as noise fits nothing: where a gauge sees hardly a signal,
/// its factor runs away, and the noise carried to it is all that is compared.
bool Search::fits_the_signal(const Refit& refit) const {
  constexpr double kShare = 0.5;
  const ModelFit& fit = refit.studied.fit;
  return base_.fit.objective() - fit.penalty - refit.chi2_in_base_noise >=
         kShare * (base_.fit.objective() - fit.objective());
}

void Search::rate_in_order(std::vector<Refit>& list) const {
  rate(list);
  std::sort(list.begin(), list.end(),
            [](const Refit& a, const Refit& b) { return a.evidence > b.evidence; });
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
    study_.executor().run(at.size(), [&](std::size_t i, std::size_t worker) {
      Refit& own = list[at[i]];
      Studied& studied = own.studied;
      ModelFit fit =
          fit_model(studied.composition, study_.residuals(), serial_on(worker), studied.fit.theta);
      const Model model = with(base_.model, candidates_[own.candidate], true);
      own = described(own.candidate, model, std::move(studied.composition), std::move(fit), worker);
    });
    std::erase_if(list, [&](Refit& own) {
      if (admissible(own)) {
        return false;
      }
      dismiss(own);
      return true;
    });
    rate_in_order(list);
  }
}

/// A relaxation much slower than the record, or quicker than a sample, is another effect's limit
/// (a dashpot, a spring) that it only imitates. So is one whose strength and time grow together
/// without end, which shows in both being less than their own deviations, and one that has taken
/// the material's own place, whose branch stands in for a dashpot or for what is slow: it is slower
/// than the record by far, or than a third of it and of a strength that is less than its deviation.
/// A strength alone is as uncertain where the time is near that of the material's own branch, from
/// which it is told by a little only.
bool Search::beyond_the_record(const Studied& studied, const Refit& refit) const {
  const Candidate& candidate = candidates_[refit.candidate];
  const EffectUse* use = studied.model.find(candidate.id());
  const auto& parameters = candidate.use.effect->about().parameters;
  constexpr double kMuchSlower = 5.0;
  const double period_s = study_.residuals().judged_period_s();
  const double record_s = period_s * static_cast<double>(study_.residuals().band().judged);
  const OwnBranch beside = own_branch(studied.model, candidate.use.effect->about().id);
  constexpr double kSlow = 0.3;  // shows as a dashpot only
  if (beside.time_s > (beside.strength_known ? kMuchSlower : kSlow) * record_s) {
    return true;
  }
  bool timeless = false;
  bool unbounded = false;
  for (std::size_t p = 0; use != nullptr && p < parameters.size(); ++p) {
    const ModelValue& own = use->values[p];
    if (!parameters[p].auxiliary()) {
      unbounded = unbounded || std::abs(own.value - parameters[p].null_value) < own.sd;
    } else if (parameters[p].unit == "s") {
      timeless = timeless || own.value < own.sd;
      if (own.value > kMuchSlower * record_s || own.value < 0.5 * study_.campaign().period_s) {
        return true;
      }
    }
  }
  return timeless && unbounded;
}

double Search::evidence_of(const Direction& direction, const Candidate& candidate) const {
  return direction.freedom > 0.0 ? equivalent_square(log_gain_tail(
                                       direction.gain, direction.freedom, candidate.one_sided))
                                 : 0.0;
}

/// The best variant of each effect, those near the best of all; first-order ties can separate at
/// finite size, the more so the larger the misfit.
std::vector<std::size_t> Search::worth_refitting() {
  std::map<std::string, std::pair<double, std::size_t>> best;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const double evidence = evidence_of(directions_[i], candidates_[i]);
    const EffectUse& use = candidates_[i].use;
    auto& own = best[use.id() + (use.per_shot ? " per shot" : "") + (use.alike ? " alike" : "")];
    if (evidence > own.first + (is_harmonic(use) ? kHarmonic : 0.0)) {
      own = {evidence, i};
    }
  }
  std::vector<std::pair<double, std::size_t>> ranked;
  for (const auto& [id, own] : best) {
    if (own.first > 0.0) {
      ranked.push_back(own);
    }
  }
  std::sort(ranked.rbegin(), ranked.rend());
  std::vector<std::size_t> chosen;
  for (const auto& [evidence, i] : ranked) {
    const double margin = std::max(25.0, 0.6 * ranked.front().first);
    // Far from the records, first order says little of what fits best.
    const bool near = evidence > ranked.front().first - margin ||
                      ((far_off() || chosen.size() < kAlwaysRefits) && evidence > kWorthRefitting);
    if (chosen.size() < kMostRefits && near) {
      chosen.push_back(i);
    }
  }
  if (safeguards_.own_strengths) {
    add_beyond_slow_noise(chosen);
  }
  add_relatives(ranked, chosen);
  return chosen;
}

/// What shots have of their own gains little by noise that was learned from their differences: of
/// each such addition, one variant that slow noise does not do.
void Search::add_beyond_slow_noise(std::vector<std::size_t>& chosen) {
  std::set<std::string> seen;
  for (const std::size_t i : chosen) {
    if (may_be_slow_noise(candidates_[i])) {
      seen.insert(candidates_[i].id());
    }
  }
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (may_be_slow_noise(candidates_[i]) && seen.insert(candidates_[i].id()).second &&
        slow_noise_excluded(slow_chance(i).least(), Claim::fresh)) {
      chosen.push_back(i);
    }
  }
}

/// What differs from a chosen candidate by more than first order only.
void Search::add_relatives(const std::vector<std::pair<double, std::size_t>>& ranked,
                           std::vector<std::size_t>& chosen) const {
  const auto is_chosen = [&](std::size_t i) {
    return std::find(chosen.begin(), chosen.end(), i) != chosen.end();
  };
  // At one gauge a delay, a filter and a length.
  for (const auto& [evidence, i] : ranked) {
    if (at_one_gauge(candidates_[i], candidates_[ranked.front().second]) && !is_chosen(i)) {
      chosen.push_back(i);
    }
  }
  // Of a hum the mains' other frequency: a record that is short beside both knows neither.
  const std::vector<std::size_t> sought = chosen;
  for (const std::size_t i : sought) {
    for (std::size_t k = 0; k < candidates_.size(); ++k) {
      if (is_other_mains(candidates_[k], candidates_[i]) && !is_chosen(k)) {
        chosen.push_back(k);
      }
    }
  }
  // What is there or not, first order takes a share of, and of what begins suddenly it tells no
  // variant from another: far from the records that says nothing.
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (far_off() && (is_switch(candidates_[i]) || is_sudden(candidates_[i])) && !is_chosen(i)) {
      chosen.push_back(i);
    }
  }
  // Of what every specimen does by formula it says little where moduli do its work.
  constexpr double kSomething = 25.0;  // of evidence: noise seldom has as much
  const bool something = !ranked.empty() && ranked.front().first > kSomething;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    if (something && has_formula(candidates_[i].use) && !is_chosen(i)) {
      chosen.push_back(i);
    }
  }
  // Of the material, what can say nothing at first order for standing at its bound.
  const bool material = std::any_of(chosen.begin(), chosen.end(),
                                    [&](std::size_t i) { return of_material(candidates_[i]); });
  for (std::size_t i = 0; material && i < candidates_.size(); ++i) {
    const EffectUse& use = candidates_[i].use;
    if (of_material(candidates_[i]) && candidates_[i].one_sided &&
        use.effect->about().parameters.size() == 1 && !use.per_shot && !is_chosen(i)) {
      chosen.push_back(i);
    }
  }
}

/// Where first order says the strengths and the model's numbers are, or as far on the way as
/// makes things better.
std::vector<double> Search::begin_near(const Candidate& candidate, const Direction& direction,
                                       const Composition& composition, std::size_t worker) const {
  std::vector<std::size_t> strengths;
  for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    const EffectUse& use = composition.uses()[number.use];
    if (use.id() == candidate.id() &&
        !use.effect->about().parameters[number.parameter].auxiliary()) {
      strengths.push_back(i);
    }
  }
  std::vector<double> best = carry(base_.composition, base_.fit.theta, composition);
  if (candidate.frees_prior ||
      static_cast<Eigen::Index>(strengths.size()) != direction.step.size()) {
    return best;
  }
  const std::vector<double> null = best;
  const Eigen::VectorXd along = -base_.fit.covariance * direction.model_share * direction.step;
  double least = study_.residuals().evaluate(composition, best, worker).squaredNorm();
  for (const double share : {1.0, 0.3, 0.1}) {
    std::vector<double> moved = base_.fit.theta;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const FreeNumber& number = base_.composition.numbers()[i];
      moved[i] = number.inside(moved[i] + share * along[static_cast<Eigen::Index>(i)]);
    }
    std::vector<double> start = carry(base_.composition, moved, composition);
    for (std::size_t i = 0; i < strengths.size(); ++i) {
      const FreeNumber& number = composition.numbers()[strengths[i]];
      start[strengths[i]] =
          number.inside(null[strengths[i]] + share * direction.step[static_cast<Eigen::Index>(i)]);
    }
    const double chi2 = study_.residuals().evaluate(composition, start, worker).squaredNorm();
    if (chi2 < least) {
      least = chi2;
      best = std::move(start);
    }
  }
  return best;
}

/// Where fits of a large strength begin. @param from  what the model's other numbers begin with
std::vector<std::vector<double>> Search::large_sizes(const Candidate& candidate,
                                                     const Composition& composition,
                                                     const std::vector<double>& from) {
  std::vector<std::vector<double>> starts;
  for (const double typicals : {1.5, 3.0, 6.0, 12.0, 24.0}) {
    std::vector<double> start = from;
    for (std::size_t i = 0; i < start.size(); ++i) {
      const FreeNumber& number = composition.numbers()[i];
      const EffectUse& use = composition.uses()[number.use];
      const EffectParameter& parameter = use.effect->about().parameters[number.parameter];
      if (use.id() == candidate.id() && !parameter.auxiliary()) {
        const double side = parameter.null_value >= parameter.upper ? -1.0 : 1.0;
        start[i] = number.inside(
            number.theta_of(parameter.null_value + side * typicals * parameter.typical));
      }
    }
    starts.push_back(std::move(start));
  }
  return starts;
}

/// The one of them that fits best as it is.
std::vector<double> Search::begin_large(const Candidate& candidate, const Composition& composition,
                                        const std::vector<double>& from, std::size_t worker) const {
  std::vector<double> best;
  double least = HUGE_VAL;
  for (std::vector<double>& start : large_sizes(candidate, composition, from)) {
    const double chi2 = study_.residuals().evaluate(composition, start, worker).squaredNorm();
    if (chi2 < least) {
      least = chi2;
      best = std::move(start);
    }
  }
  return best;
}

/// Derivatives by a composition's numbers as they are beside the model without the candidate; none
/// where these say too little: of a relaxation time while its strength is null, of what grows by
/// its square, or where the model is far off.
std::optional<Eigen::MatrixXd> Search::chord_of(const Candidate& candidate,
                                                const Direction& direction,
                                                const Composition& composition) const {
  if (may_be_astray_) {
    return std::nullopt;
  }
  const auto& numbers = composition.numbers();
  Eigen::MatrixXd chord(base_.fit.residual.size(), static_cast<Eigen::Index>(numbers.size()));
  std::vector<bool> taken(base_.fit.theta.size(), false);
  Eigen::Index strength = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<std::size_t> held = place_in(base_.composition, composition, i, taken);
    const auto column = static_cast<Eigen::Index>(i);
    if (numbers[i].power != 1.0) {
      return std::nullopt;
    }
    if (held) {
      taken[*held] = true;
      const double scale = numbers[i].scale / base_.composition.numbers()[*held].scale;
      chord.col(column) = scale * base_.fit.jacobian.col(static_cast<Eigen::Index>(*held));
    } else if (composition.uses()[numbers[i].use].id() == candidate.id() &&
               strength < direction.columns.cols()) {
      chord.col(column) = direction.columns.col(strength++);
    } else {
      return std::nullopt;
    }
  }
  return chord;
}

/// Whether its fit begins once more from where the model's numbers started: these may have gone
/// astray without it, and what the model holds of the same matter has moved them to where the two
/// of them are not.
bool Search::begins_afresh(const Candidate& candidate) const {
  if (may_be_astray_) {
    return !(far_off() && is_sudden(candidate));
  }
  const Stage stage = candidate.use.effect->about().stage;
  const bool of_matter = stage == Stage::material || stage == Stage::specimen;
  return of_matter && std::ranges::any_of(afresh_.effects, [&](const EffectUse& use) {
           const EffectAbout& about = use.effect->about();
           return about.stage == stage && !about.base && use.id() != candidate.id();
         });
}

std::optional<Refit> Search::refit(std::size_t index, std::size_t worker) {
  const Candidate& candidate = candidates_[index];
  const Direction& direction = directions_[index];
  const Model model = with(base_.model, candidate, true);
  Composition composition(model, study_.campaign());
  const auto chord = chord_of(candidate, direction, composition);
  const auto fit_from = [&](std::vector<double> theta, const Eigen::MatrixXd* known = nullptr) {
    return begun_from(composition, std::move(theta), known, worker);
  };
  ModelFit fit =
      fit_from(begin_near(candidate, direction, composition, worker), chord ? &*chord : nullptr);
  if (begins_afresh(candidate)) {
    const Composition again(with(afresh_, candidate, true), study_.campaign());
    better_of(fit, fit_from(carry(again, again.start(), composition)));
  }
  from_large_sizes(index, composition, worker, fit);
  constexpr double kFallsShort = 0.5;
  if (base_.fit.objective() - fit.objective() < kFallsShort * direction.gain) {
    from_other_starts(index, composition, worker, fit);
  }
  if (put_branches_in_order(composition, fit.theta)) {
    fit = fit_from(fit.theta);
  }
  Refit out = described(index, model, std::move(composition), std::move(fit), worker);
  out.rough = chord || far_off();
  return out;
}

/// At null its first order is what others take up, or a large one bends away from it: only a finite
/// size shows what it does. @param fit  takes what is better
void Search::from_large_sizes(std::size_t index, const Composition& composition, std::size_t worker,
                              ModelFit& fit) {
  const Candidate& candidate = candidates_[index];
  const bool even = candidate.use.effect->about().parameters.front().power != 1.0;
  const bool bends = (even && may_be_astray_) || (is_sudden(candidate) && far_off());
  if (!candidate.one_sided ||
      !(bends || evidence_of(directions_[index], candidate) < kWorthRefitting)) {
    return;
  }
  const auto begin = [&](std::vector<double> theta) {
    better_of(fit, begun_from(composition, std::move(theta), nullptr, worker));
  };
  if (!far_off() || !is_sudden(candidate)) {
    begin(begin_large(candidate, composition,
                      carry(base_.composition, base_.fit.theta, composition), worker));
    return;
  }
  // Until the model's other numbers are fitted, none of its sizes says which is the right one.
  const Composition again(with(afresh_, candidate, true), study_.campaign());
  for (std::vector<double>& start :
       large_sizes(candidate, composition, carry(again, again.start(), composition))) {
    begin(std::move(start));
  }
}

/// Where the model is far off, many beginnings lead nowhere: by secants, and in the noise that the
/// model had, they show that soonest.
ModelFit Search::begun_from(const Composition& composition, std::vector<double> theta,
                            const Eigen::MatrixXd* chord, std::size_t worker) const {
  if (!far_off()) {
    return fit_model(composition, study_.residuals(), serial_on(worker), std::move(theta), chord);
  }
  InNoiseOf residuals(study_.residuals(), base_);
  return fit_by_secants(composition, residuals, serial_on(worker), std::move(theta), nullptr,
                        Settle::roughly);
}

/// A fit that gains much less than first order has led elsewhere: it is begun where the effect's
/// other variants would begin, those that promise most first. @param fit  takes what is better
void Search::from_other_starts(std::size_t index, const Composition& composition,
                               std::size_t worker, ModelFit& fit) {
  constexpr std::size_t kStarts = 3;
  const EffectUse& own = candidates_[index].use;
  std::vector<std::size_t> variants;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const EffectUse& use = candidates_[i].use;
    if (i != index && use.id() == own.id() && use.per_shot == own.per_shot &&
        use.alike == own.alike && candidates_[i].frees_prior == candidates_[index].frees_prior) {
      variants.push_back(i);
    }
  }
  std::ranges::stable_sort(variants, std::greater{},
                           [&](std::size_t i) { return directions_[i].gain; });
  variants.resize(std::min(variants.size(), kStarts));
  for (const std::size_t i : variants) {
    const Composition other(with(base_.model, candidates_[i], true), study_.campaign());
    if (other.numbers().size() != composition.numbers().size()) {
      continue;
    }
    ModelFit found = begun_from(
        composition,
        carry(other, begin_near(candidates_[i], directions_[i], other, worker), composition),
        nullptr, worker);
    better_of(fit, std::move(found));
  }
}

Refit Search::described(std::size_t index, const Model& model, Composition composition,
                        ModelFit fit, std::size_t worker) {
  const Candidate& candidate = candidates_[index];
  const Misfit misfit =
      misfit_of(study_.residuals(), fit.residual, fit.degrees_of_freedom(composition), worker);
  Refit out{index,
            {fitted(model, composition, fit), std::move(composition), std::move(fit), misfit}};
  const double freedom = base_.fit.degrees_of_freedom(base_.composition) -
                         out.studied.fit.degrees_of_freedom(out.studied.composition);
  out.freedom = candidate.frees_prior ? 1.0 : std::round(freedom);
  out.one_sided = candidate.one_sided && freedom < 1.5;
  out.scatter = scatter_over_noise(out.studied, candidate.id(), study_.residuals().per_shot());
  out.chi2_in_base_noise =
      study_.residuals()
          .evaluate_in_noise_of(base_.composition, base_.fit.theta, out.studied.composition,
                                out.studied.fit.theta, worker)
          .squaredNorm();
  out.products = product_test_of(out.studied, candidate.id(), study_.campaign());
  return out;
}

/// Rates rivals by one measure of the noise, that of the best: what they leave of each other's
/// misfit must not count as noise.
void Search::rate(std::vector<Refit>& list) const {
  const auto best = std::min_element(list.begin(), list.end(), [](const Refit& a, const Refit& b) {
    return a.studied.fit.objective() < b.studied.fit.objective();
  });
  if (best == list.end()) {
    return;
  }
  const double noise = noise_of(best->studied.misfit, study_.campaign().shots.size());
  for (Refit& refit : list) {
    double over_noise = (base_.fit.objective() - refit.studied.fit.objective()) / noise;
    refit.beside = share_beside_unconfirmed(
        refit, equivalent_square(log_gain_tail(over_noise, refit.freedom, refit.one_sided)));
    over_noise *= refit.beside;
    refit.noise = noise;
    refit.over_noise = over_noise;
    refit.gain = over_noise / refit.scatter;
    refit.log_p = chance_of(refit, refit.gain);
    // The shots' scatter tells how well a gain is known, and only roughly: divided by one rival's
    // own, what fits best would come behind what fits worse. But slow noise gives additions more
    // than their rivals.
    const bool addition = is_addition(*candidates_[refit.candidate].use.effect);
    refit.doubt = addition ? 1.0 : refit.scatter;
    // Additions are weighed by what their shots scatter already.
    refit.known =
        addition ? kKnownWell : std::min(kKnownWell, known_of(candidates_[refit.candidate].use));
    refit.rival_log_p = addition ? refit.log_p : chance_of(refit, over_noise);
    refit.evidence = equivalent_square(
        log_gain_tail(addition ? refit.gain : over_noise, refit.freedom, refit.one_sided));
    if (refit.products) {
      // What differs between the shots may have been taken for noise: then its gain says too
      // little.
      refit.evidence = std::max(refit.evidence, equivalent_square(refit.log_p));
    }
    if (refit.slow) {
      // The noise that it is weighed by holds it: what remains without tells more. A rival it meets
      // by itself.
      refit.evidence = equivalent_square(refit.slow->alone);
    }
  }
}

/// ln of the chance of a gain on noise as a refit's, whose power in its direction the shots tell no
/// better than so many degrees of freedom do.
double Search::chance_of(const Refit& refit, double gain) const {
  const EffectUse& use = candidates_[refit.candidate].use;
  if (refit.products) {
    // Nothing else is judged by products: what has been sought among is the effect's own variants.
    const auto variants = std::count_if(candidates_.begin(), candidates_.end(), [&](const auto& c) {
      return c.id() == use.id() && c.use.per_shot && !c.use.alike;
    });
    const double chance = refit.products->log_p + std::log(static_cast<double>(variants));
    return std::min(chance, refit.slow ? refit.slow->least() : 0.0) - std::log(trials_);
  }
  if (refit.slow) {
    return refit.slow->least() - std::log(trials_);
  }
  if (use.per_shot || gain <= 0.0) {
    return log_gain_tail(gain, refit.freedom, refit.one_sided);
  }
  const double freedom = std::max(refit.freedom, 1.0);
  const double log_p = log_f_tail(gain / freedom, freedom, known_of(use));
  return refit.one_sided ? log_p - std::log(2.0) : log_p;
}

}  // namespace kolsky

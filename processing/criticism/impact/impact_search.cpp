#include "processing/criticism/impact/impact_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "processing/base/error.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/impact/impact_notes.hpp"
#include "processing/criticism/impact/quiet_before.hpp"
#include "processing/criticism/impact/solver_share.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/search_trials.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kMostRefits = 12;

/// By how much what may yet turn out best is behind the best: first order and fits from one side
/// say little where much is missing.
double margin_behind(double best) {
  return std::max(150.0, 0.6 * best);
}

/// Every strength over its reach would change the records by less than noise does.
bool beyond_reach(const Candidate& candidate, const Direction& direction) {
  if (direction.freedom <= 0.0 || !std::isfinite(direction.gain) ||
      direction.information.rows() == 0) {
    return true;
  }
  const EffectParameter& p = candidate.use.effect->about().parameters.front();
  const double scale = scale_of(candidate.use.values.front(), p);
  const double information = direction.information.diagonal().maxCoeff();
  return !(information > 0.0) || scale / std::sqrt(information) > p.upper - p.lower;
}

Direction untestable(Direction direction) {
  direction.freedom = direction.gain = 0.0;
  return direction;
}

/// Where first order says the strengths are.
std::vector<double> begin_near(const Candidate& candidate, const Direction& direction,
                               const Studied& base, const Composition& composition) {
  std::vector<double> start = carry(base.composition, base.fit.theta, composition);
  Eigen::Index k = 0;
  for (std::size_t i = 0; i < start.size() && !candidate.frees_prior; ++i) {
    const FreeNumber& number = composition.numbers()[i];
    const EffectUse& use = composition.uses()[number.use];
    if (use.id() == candidate.id() &&
        !use.effect->about().parameters[number.parameter].auxiliary() &&
        k < direction.step.size()) {
      start[i] = number.inside(start[i] + direction.step[k++]);
    }
  }
  return start;
}

/// Derivatives for a refit from those at hand: the model's own and the candidate's at null. Empty
/// where a number has none there (a time that goes with a strength).
Eigen::MatrixXd borrowed(const Candidate& candidate, const Direction& direction,
                         const Studied& base, const Composition& composition) {
  const std::vector<FreeNumber>& held = base.composition.numbers();
  std::vector<bool> taken(held.size(), false);
  Eigen::MatrixXd columns(base.fit.residual.size(),
                          static_cast<Eigen::Index>(composition.numbers().size()));
  Eigen::Index added = 0;
  for (std::size_t i = 0; i < composition.numbers().size(); ++i) {
    const FreeNumber& wanted = composition.numbers()[i];
    const std::string id = composition.uses()[wanted.use].id();
    const auto column = static_cast<Eigen::Index>(i);
    std::size_t k = 0;
    while (k < held.size() && (taken[k] || held[k].parameter != wanted.parameter ||
                               base.composition.uses()[held[k].use].id() != id)) {
      ++k;
    }
    if (k < held.size()) {
      taken[k] = true;
      columns.col(column) =
          base.fit.jacobian.col(static_cast<Eigen::Index>(k)) * (wanted.scale / held[k].scale);
    } else if (id == candidate.id() && added < direction.columns.cols()) {
      columns.col(column) = direction.columns.col(added++);
    } else {
      return {};
    }
  }
  return columns;
}

/// Whether a candidate is one filed number set free: what it does far from there, first order does
/// not say (friction acts most where there is little of it).
bool is_filed_number(const Candidate& candidate) {
  return candidate.frees_prior && candidate.use.values.size() == 1;
}

ModelFit better_of(ModelFit fit, ModelFit other) {
  const bool better = std::isfinite(other.objective()) && !(fit.objective() <= other.objective());
  return better ? std::move(other) : std::move(fit);
}

/// From three filed deviations to either side. @return the best of these and `fit`
ModelFit from_afar(const Candidate& candidate, ModelFit fit, const Composition& composition,
                   const std::vector<double>& start, ShotResiduals& residuals,
                   const Workers& executor) {
  for (const double deviations : {-3.0, 3.0}) {
    std::vector<double> there = start;
    for (std::size_t i = 0; i < there.size(); ++i) {
      const FreeNumber& number = composition.numbers()[i];
      if (composition.uses()[number.use].id() == candidate.id()) {
        const ModelValue& filed = candidate.use.values.front();
        there[i] = number.inside(number.theta_of(filed.prior_mean + deviations * filed.prior_sd));
      }
    }
    fit = better_of(std::move(fit), fit_by_secants(composition, residuals, executor, there, nullptr,
                                                   Settle::roughly));
  }
  return fit;
}

/// Whether two are the same of the few forms that an effect has.
bool same_choice(const EffectUse& a, const EffectUse& b) {
  const std::vector<EffectParameter>& parameters = a.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].chosen && a.values[p].value != b.values[p].value) {
      return false;
    }
  }
  return true;
}

}  // namespace

ImpactSearch::ImpactSearch(ImpactStudy& study, const Studied& base)
    : study_(study),
      base_(study.by_coarse_mesh(base)),
      astray_(strained(base_.composition, base_.fit.theta) || law_beyond_bounds(base_) > kPressed),
      candidates_(candidates_for(base_, study.campaign())),
      directions_(candidates_.size()),
      flat_(candidates_.size()),
      evidence_(candidates_.size(), 0.0) {
  study.executor().run(candidates_.size(), [&](std::size_t i, std::size_t worker) {
    const Candidate& own = candidates_[i];
    Direction& direction = directions_[i];
    direction = direction_of(own, base_, study.campaign(), study.residuals(), worker);
    if (beyond_reach(own, direction)) {
      flat_[i] = flat_effect(study, base_, own, kStandsBefore * kSolverDoubt, worker);
      direction = flat_[i] ? flat_[i]->secant : untestable(std::move(direction));
    }
    // First order may promise more than there is.
    direction.gain = std::min(direction.gain, base_.fit.objective());
    if (direction.freedom > 0.0) {
      evidence_[i] = equivalent_square(log_gain_tail(direction.gain, direction.freedom, own.signs));
    }
  });
  trials_ = independent_trials(base_, candidates_, directions_);
}

std::vector<FlatEffect> ImpactSearch::flat() const {
  std::vector<FlatEffect> list;
  for (const auto& own : flat_) {
    if (own) {
      list.push_back(*own);
    }
  }
  return list;
}

double ImpactSearch::log_trials() const {
  return std::log(trials_);
}

double ImpactSearch::with_search(double log_p) const {
  return std::min(0.0, log_p + std::log(trials_));
}

double ImpactSearch::solver_share() const {
  return largest_solver_share(study_.residuals().whitening(), base_.fit, candidates_, directions_);
}

/// The best variant of each effect within the margin: first order says little where much is
/// missing.
std::vector<std::size_t> ImpactSearch::worth_refitting() const {
  std::map<std::string, std::size_t> best;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const EffectUse& use = candidates_[i].use;
    const auto [held, is_new] = best.try_emplace(use.id() + (use.per_shot ? " per shot" : ""), i);
    if (!is_new && evidence_[i] > evidence_[held->second]) {
      held->second = i;
    }
  }
  std::vector<std::size_t> ranked;
  for (const auto& [id, i] : best) {
    ranked.push_back(i);
  }
  std::sort(ranked.begin(), ranked.end(),
            [&](std::size_t a, std::size_t b) { return evidence_[a] > evidence_[b]; });
  std::vector<std::size_t> chosen;
  std::size_t nearest = 0;
  constexpr double kWorthIt = 4.0;
  for (const std::size_t i : ranked) {
    const double first = evidence_[ranked.front()];
    const bool near =
        evidence_[i] > kWorthIt && (astray_ || evidence_[i] > first - margin_behind(first));
    const bool filed = directions_[i].freedom > 0.0 && is_filed_number(candidates_[i]);
    nearest += near ? 1 : 0;
    if (filed || (near && nearest <= kMostRefits)) {
      chosen.push_back(i);
    }
  }
  add_variants_as_likely(chosen);
  return chosen;
}

/// What is one of a few (bending as the section's turn or as the deflection's curvature) first
/// order does not tell where much is missing: the nearest of the others are refitted, too.
void ImpactSearch::add_variants_as_likely(std::vector<std::size_t>& chosen) const {
  constexpr double kAsLikely = 0.9;
  constexpr double kMuch = kStandsBefore * kSolverDoubt;
  constexpr std::size_t kMostOthers = 2;
  for (const std::size_t best : std::vector<std::size_t>(chosen)) {
    const Candidate& own = candidates_[best];
    const bool one_of_few =
        std::ranges::any_of(own.use.effect->about().parameters, &EffectParameter::chosen);
    std::vector<std::size_t> others;
    for (std::size_t i = 0; one_of_few && evidence_[best] > kMuch && i < candidates_.size(); ++i) {
      const Candidate& other = candidates_[i];
      if (i != best && other.id() == own.id() && other.use.per_shot == own.use.per_shot &&
          evidence_[i] > kAsLikely * evidence_[best]) {
        others.push_back(i);
      }
    }
    std::ranges::stable_sort(others, std::ranges::greater{},
                             [&](std::size_t i) { return evidence_[i]; });
    others.resize(std::min(others.size(), kMostOthers));
    chosen.insert(chosen.end(), others.begin(), others.end());
  }
}

/// @param known  a fit that holds it, to begin from as well; none: null
std::optional<ImpactRefit> ImpactSearch::refit(std::size_t index, const Workers& executor,
                                               double least, const Studied* known) {
  const Candidate& candidate = candidates_[index];
  const Model model = with(base_.model, candidate, Auxiliaries::free);
  Composition composition(model, study_.campaign());
  const Eigen::MatrixXd chord = borrowed(candidate, directions_[index], base_, composition);
  ModelFit fit = fit_by_secants(composition, study_.residuals(), executor,
                                begin_near(candidate, directions_[index], base_, composition),
                                chord.size() > 0 ? &chord : nullptr, Settle::roughly);
  if (!std::isfinite(fit.objective())) {
    // First order led to a ball that the solver refuses: begin at null.
    fit = fit_by_secants(composition, study_.residuals(), executor,
                         carry(base_.composition, base_.fit.theta, composition), nullptr,
                         Settle::roughly);
  }
  const auto try_from = [&](std::vector<double> start) {
    fit = better_of(std::move(fit), fit_by_secants(composition, study_.residuals(), executor,
                                                   std::move(start), nullptr, Settle::roughly));
  };
  if (astray_) {
    // From where friction and law took up what is missing, what is missing gains little.
    try_from(as_filed(composition, carry(base_.composition, base_.fit.theta, composition)));
  }
  if (known != nullptr) {
    try_from(carry(known->composition, known->fit.theta, composition));
  }
  const double objective = fit.objective();
  if (is_filed_number(candidate) && !(base_.fit.objective() - objective < least)) {
    fit = from_afar(candidate, std::move(fit), composition,
                    carry(base_.composition, base_.fit.theta, composition), study_.residuals(),
                    executor);
  }
  return described(index, model, std::move(composition), std::move(fit));
}

std::optional<ImpactRefit> ImpactSearch::described(std::size_t index, const Model& model,
                                                   Composition composition, ModelFit fit) const {
  if (!std::isfinite(fit.objective()) || !fit.covariance.allFinite()) {
    return std::nullopt;
  }
  const Candidate& candidate = candidates_[index];
  ImpactRefit out{index, study_.finish(model, std::move(composition), std::move(fit))};
  out.confirmed =
      own_strengths_confirmed(out.studied, candidate.id(), study_.campaign(), Claim::fresh);
  const double freedom = base_.fit.degrees_of_freedom(base_.composition) -
                         out.studied.fit.degrees_of_freedom(out.studied.composition);
  out.freedom = candidate.frees_prior ? 1.0 : std::max(1.0, std::round(freedom));
  out.lowers = base_.fit.objective() - out.studied.fit.objective();
  out.lowers_filed = base_.fit.penalty - out.studied.fit.penalty;
  return out;
}

void ImpactSearch::rate() {
  const auto best =
      std::min_element(refits_.begin(), refits_.end(), [](const auto& a, const auto& b) {
        return a.studied.fit.objective() < b.studied.fit.objective();
      });
  // By one measure of it: what takes up how shots scatter leaves less noise, and of a large misfit
  // each of its own made that more than what it explains.
  noise_ = std::max(1.0, best->studied.misfit.noise_scale);
  const auto [chi2, known] = study_.repeated(best->studied.fit.residual);
  scale_ = std::max(kSolverDoubt, chi2 / known);
  for (ImpactRefit& refit : refits_) {
    refit.gain = refit.lowers / noise_;
    refit.of_filed = refit.lowers_filed / noise_;
    const Signs signs = refit.freedom < 1.5 ? candidate(refit).signs : Signs::both;
    const double beside_rivals = (refit.gain - refit.of_filed) / scale_ + refit.of_filed;
    refit.evidence =
        equivalent_square(log_gain_tail(std::max(0.0, beside_rivals), refit.freedom, signs));
    const double squares = std::max(0.0, refit.gain) /
                           doubt_of_gain(candidate(refit), directions_[refit.candidate], scale_);
    const double by_chi2 = log_gain_tail(squares, refit.freedom, signs);
    refit.log_p = scale_ > kSolverDoubt
                      ? log_f_tail(squares / refit.freedom, refit.freedom, known) -
                            (signs == Signs::one ? std::log(2.0) : 0.0)
                      : by_chi2;
  }
}

/// One to a worker; fewer than there are workers one after the other, each with all of them.
void ImpactSearch::share_out(std::size_t count,
                             const std::function<void(std::size_t, const Workers&)>& work) {
  if (count < study_.executor().workers) {
    for (std::size_t i = 0; i < count; ++i) {
      work(i, study_.executor());
    }
    return;
  }
  study_.executor().run(count,
                        [&](std::size_t i, std::size_t worker) { work(i, serial_on(worker)); });
}

/// Fits to the end what may be claimed, and what may stand beside it.
void ImpactSearch::refine() {
  const auto best =
      std::max_element(refits_.begin(), refits_.end(),
                       [](const auto& a, const auto& b) { return a.evidence < b.evidence; });
  constexpr double kInSight = -3.0;  ///< ln p: what a rough fit misses moves it by less than a half
  constexpr double kNearBest = 15.0;  ///< twice what a tie needs
  if (best == refits_.end() || with_search(best->log_p) > kInSight) {
    return;
  }
  std::vector<ImpactRefit*> near;
  for (ImpactRefit& own : refits_) {
    if (own.evidence >= best->evidence - kNearBest) {
      near.push_back(&own);
    }
  }
  share_out(near.size(), [&](std::size_t i, const Workers& executor) {
    ImpactRefit& own = *near[i];
    const Studied& rough = own.studied;
    ModelFit fit = fit_by_secants(rough.composition, study_.residuals(), executor, rough.fit.theta,
                                  &rough.fit.jacobian);
    if (auto refined = described(own.candidate, rough.model, rough.composition, std::move(fit));
        refined && refined->confirmed) {
      own = std::move(*refined);
    }
  });
  rate();
}

void ImpactSearch::sort_by_evidence() {
  std::sort(refits_.begin(), refits_.end(),
            [](const auto& a, const auto& b) { return a.evidence > b.evidence; });
}

void ImpactSearch::settle_nearest(const Studied& base) {
  constexpr std::size_t kNearest = 3;
  std::size_t count = 0;
  for (ImpactRefit& own : refits_) {
    if (candidate(own).frees_prior) {
      continue;
    }
    std::optional<Studied> settled;
    try {
      settled = study_.settled(own.studied, Settle::roughly);
    } catch (const InputError&) {
      continue;  // nowhere near is a ball that finer meshes take: it stays as rough as it is
    }
    const Studied& studied = *settled;
    own.lowers = base.fit.objective() - studied.fit.objective();
    own.lowers_filed = base.fit.penalty - studied.fit.penalty;
    own.studied = studied;
    if (++count == kNearest) {
      break;
    }
  }
  study_.residuals().anchor(base.composition, base.fit.theta, ImpactResiduals::AnchorBy::middle);
  if (count > 0) {
    rate();
    sort_by_evidence();
  }
}

void ImpactSearch::leave_out_what_quiet_lacks() {
  not_in_quiet_.clear();
  std::erase_if(refits_, [&](const ImpactRefit& own) {
    const std::string id = candidate(own).id();
    const bool lacks = !stands_before_pulse(own.studied, id, study_.residuals());
    if (lacks && own.lowers > kStandsBefore * kSolverDoubt) {
      not_in_quiet_.insert(id);
    }
    return lacks;
  });
  for (const ImpactRefit& own : refits_) {
    not_in_quiet_.erase(candidate(own).id());  // in another variant it is there
  }
}

std::optional<ImpactSearch::Known> ImpactSearch::known(const std::string& id,
                                                       const Studied& found) const {
  const EffectUse* use = found.model.find(id);
  std::optional<Known> best;
  for (std::size_t i = 0; use != nullptr && i < candidates_.size(); ++i) {
    const EffectUse& own = candidates_[i].use;
    if (own.id() == id && own.per_shot == use->per_shot && own.alike == use->alike &&
        same_choice(own, *use) && (!best || evidence_[i] > evidence_[best->candidate])) {
      best.emplace(i, found);
    }
  }
  return best;
}

void ImpactSearch::refit_rivals() {
  refit_rivals(std::nullopt);
}

void ImpactSearch::refit_rivals(const std::string& id, const Studied& found) {
  refit_rivals(known(id, found));
}

void ImpactSearch::refit_rivals(const std::optional<Known>& known) {
  std::vector<std::size_t> chosen = worth_refitting();
  if (known && std::ranges::find(chosen, known->candidate) == chosen.end()) {
    chosen.push_back(known->candidate);
  }
  const auto refitted = [&](std::size_t i, const Workers& executor, double least) {
    return refit(i, executor, least, known && known->candidate == i ? &known->studied : nullptr);
  };
  const auto from_afar_too =
      std::stable_partition(chosen.begin(), chosen.end(),
                            [&](std::size_t i) { return !is_filed_number(candidates_[i]); });
  const auto near = static_cast<std::size_t>(from_afar_too - chosen.begin());
  std::vector<std::optional<ImpactRefit>> done(chosen.size());
  share_out(near, [&](std::size_t i, const Workers& executor) {
    done[i] = refitted(chosen[i], executor, 0.0);
  });
  double best = 0.0;
  for (const auto& own : done) {
    best = own ? std::max(best, base_.fit.objective() - own->studied.fit.objective()) : best;
  }
  for (std::size_t i = near; i < chosen.size(); ++i) {
    done[i] = refitted(chosen[i], study_.executor(), best - margin_behind(best));
  }
  refits_.clear();
  for (auto& own : done) {
    if (own) {
      refits_.push_back(std::move(*own));
    }
  }
  leave_out_what_quiet_lacks();
  const auto first = std::ranges::stable_partition(refits_, &ImpactRefit::confirmed).begin();
  unconfirmed_.assign(std::make_move_iterator(first), std::make_move_iterator(refits_.end()));
  refits_.erase(first, refits_.end());
  if (!refits_.empty()) {
    rate();
    refine();
  }
  sort_by_evidence();
}

}  // namespace kolsky

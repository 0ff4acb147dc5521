#include "processing/criticism/search/refitter.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/in_noise_of.hpp"
#include "processing/criticism/fitting/moduli_starts.hpp"
#include "processing/criticism/search/candidate_kinds.hpp"
#include "processing/criticism/search/own_strengths.hpp"
#include "processing/criticism/search/shot_strengths.hpp"

namespace kolsky {

namespace {

void better_of(ModelFit& fit, ModelFit other) {
  if (other.objective() < fit.objective()) {
    fit = std::move(other);
  }
}

}  // namespace

Refitter::Refitter(const SearchGround& ground, const Model& start)
    : ground_(ground), afresh_(start) {
  if (std::ranges::any_of(ground.candidates, [&](const auto& own) { return begins_afresh(own); })) {
    start_moduli(afresh_, ground.study.campaign(), ground.study.residuals());
  }
}

/// Whether its fit begins once more from where the model's numbers started: these may have gone
/// astray without it, and what the model holds of the same matter has moved them to where the two
/// of them are not.
bool Refitter::begins_afresh(const Candidate& candidate) const {
  if (ground_.may_be_astray) {
    return !(ground_.far_off() && is_sudden(candidate));
  }
  const Stage stage = candidate.use.effect->about().stage;
  const bool of_matter = stage == Stage::material || stage == Stage::specimen;
  return of_matter && std::ranges::any_of(afresh_.effects, [&](const EffectUse& use) {
           const EffectAbout& about = use.effect->about();
           return about.stage == stage && !about.base && use.id() != candidate.id();
         });
}

/// Where the model is far off, many beginnings lead nowhere: by secants, and in the noise that the
/// model had, they show that soonest.
ModelFit Refitter::begun_from(const Composition& composition, std::vector<double> theta,
                              const Eigen::MatrixXd* chord, std::size_t worker) const {
  if (!ground_.far_off()) {
    return fit_model(composition, ground_.study.residuals(), serial_on(worker), std::move(theta),
                     chord);
  }
  InNoiseOf residuals(ground_.study.residuals(), ground_.base);
  return fit_by_secants(composition, residuals, serial_on(worker), std::move(theta), nullptr,
                        Settle::roughly);
}

Refit Refitter::refit(std::size_t index, std::size_t worker) const {
  const Candidate& candidate = ground_.candidates[index];
  const Direction& direction = ground_.directions[index];
  const Model model = with(ground_.base.model, candidate, Auxiliaries::free);
  Composition composition(model, ground_.study.campaign());
  const auto chord = chord_of(candidate, direction, composition);
  const auto fit_from = [&](std::vector<double> theta, const Eigen::MatrixXd* known = nullptr) {
    return begun_from(composition, std::move(theta), known, worker);
  };
  ModelFit fit =
      fit_from(begin_near(candidate, direction, composition, worker), chord ? &*chord : nullptr);
  if (begins_afresh(candidate)) {
    const Composition again(with(afresh_, candidate, Auxiliaries::free), ground_.study.campaign());
    better_of(fit, fit_from(carry(again, again.start(), composition)));
  }
  from_large_sizes(index, composition, worker, fit);
  constexpr double kFallsShort = 0.5;
  if (ground_.base.fit.objective() - fit.objective() < kFallsShort * direction.gain) {
    from_other_starts(index, composition, worker, fit);
  }
  if (put_branches_in_order(composition, fit.theta)) {
    fit = fit_from(fit.theta);
  }
  Refit out = described(index, model, std::move(composition), std::move(fit), worker);
  out.rough = chord || ground_.far_off();
  return out;
}

/// Where first order says the strengths and the model's numbers are, or as far on the way as
/// makes things better.
std::vector<double> Refitter::begin_near(const Candidate& candidate, const Direction& direction,
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
  const std::vector<double> null =
      carry(ground_.base.composition, ground_.base.fit.theta, composition);
  if (candidate.frees_prior ||
      static_cast<Eigen::Index>(strengths.size()) != direction.step.size()) {
    return null;
  }
  const Eigen::VectorXd along =
      -ground_.base.fit.covariance * direction.model_share * direction.step;
  std::vector<std::vector<double>> starts{null};
  for (const double share : {1.0, 0.3, 0.1}) {
    std::vector<double> moved = ground_.base.fit.theta;
    for (std::size_t i = 0; i < moved.size(); ++i) {
      const FreeNumber& number = ground_.base.composition.numbers()[i];
      moved[i] = number.inside(moved[i] + share * along[static_cast<Eigen::Index>(i)]);
    }
    std::vector<double> start = carry(ground_.base.composition, moved, composition);
    for (std::size_t i = 0; i < strengths.size(); ++i) {
      const FreeNumber& number = composition.numbers()[strengths[i]];
      start[strengths[i]] =
          number.inside(null[strengths[i]] + share * direction.step[static_cast<Eigen::Index>(i)]);
    }
    starts.push_back(std::move(start));
  }
  return fits_best(std::move(starts), composition, worker);
}

/// Where fits of a large strength begin. @param from  what the model's other numbers begin with
std::vector<std::vector<double>> Refitter::large_sizes(const Candidate& candidate,
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

/// The one of them that fits best as it is, of those that do so equally the first.
std::vector<double> Refitter::fits_best(std::vector<std::vector<double>> starts,
                                        const Composition& composition, std::size_t worker) const {
  std::vector<double> best = starts.front();
  double least = HUGE_VAL;
  for (std::vector<double>& start : starts) {
    const double chi2 =
        ground_.study.residuals().evaluate(composition, start, worker).squaredNorm();
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
std::optional<Eigen::MatrixXd> Refitter::chord_of(const Candidate& candidate,
                                                  const Direction& direction,
                                                  const Composition& composition) const {
  if (ground_.may_be_astray) {
    return std::nullopt;
  }
  const auto& numbers = composition.numbers();
  Eigen::MatrixXd chord(ground_.base.fit.residual.size(),
                        static_cast<Eigen::Index>(numbers.size()));
  std::vector<bool> taken(ground_.base.fit.theta.size(), false);
  Eigen::Index strength = 0;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<std::size_t> held =
        place_in(ground_.base.composition, composition, i, taken);
    const auto column = static_cast<Eigen::Index>(i);
    if (numbers[i].power != 1.0) {
      return std::nullopt;
    }
    if (held) {
      taken[*held] = true;
      const double scale = numbers[i].scale / ground_.base.composition.numbers()[*held].scale;
      chord.col(column) = scale * ground_.base.fit.jacobian.col(static_cast<Eigen::Index>(*held));
    } else if (composition.uses()[numbers[i].use].id() == candidate.id() &&
               strength < direction.columns.cols()) {
      chord.col(column) = direction.columns.col(strength++);
    } else {
      return std::nullopt;
    }
  }
  return chord;
}

/// At null its first order is what others take up, or a large one bends away from it: only a finite
/// size shows what it does. @param fit  takes what is better
void Refitter::from_large_sizes(std::size_t index, const Composition& composition,
                                std::size_t worker, ModelFit& fit) const {
  const Candidate& candidate = ground_.candidates[index];
  const bool even = candidate.use.effect->about().parameters.front().power != 1.0;
  const bool bends = (even && ground_.may_be_astray) || (is_sudden(candidate) && ground_.far_off());
  if (candidate.signs == Signs::both || !(bends || ground_.evidence_of(index) < kWorthRefitting)) {
    return;
  }
  const auto begin = [&](std::vector<double> theta) {
    better_of(fit, begun_from(composition, std::move(theta), nullptr, worker));
  };
  if (!ground_.far_off() || !is_sudden(candidate)) {
    const std::vector<double> from =
        carry(ground_.base.composition, ground_.base.fit.theta, composition);
    begin(fits_best(large_sizes(candidate, composition, from), composition, worker));
    return;
  }
  // Until the model's other numbers are fitted, none of its sizes says which is the right one.
  const Composition again(with(afresh_, candidate, Auxiliaries::free), ground_.study.campaign());
  for (std::vector<double>& start :
       large_sizes(candidate, composition, carry(again, again.start(), composition))) {
    begin(std::move(start));
  }
}

/// A fit that gains much less than first order has led elsewhere: it is begun where the effect's
/// other variants would begin, those that promise most first. @param fit  takes what is better
void Refitter::from_other_starts(std::size_t index, const Composition& composition,
                                 std::size_t worker, ModelFit& fit) const {
  constexpr std::size_t kStarts = 3;
  const EffectUse& own = ground_.candidates[index].use;
  std::vector<std::size_t> variants;
  for (std::size_t i = 0; i < ground_.candidates.size(); ++i) {
    const EffectUse& use = ground_.candidates[i].use;
    if (i != index && use.id() == own.id() && use.per_shot == own.per_shot &&
        use.alike == own.alike &&
        ground_.candidates[i].frees_prior == ground_.candidates[index].frees_prior) {
      variants.push_back(i);
    }
  }
  std::ranges::stable_sort(variants, std::greater{},
                           [&](std::size_t i) { return ground_.directions[i].gain; });
  variants.resize(std::min(variants.size(), kStarts));
  for (const std::size_t i : variants) {
    const Composition other(with(ground_.base.model, ground_.candidates[i], Auxiliaries::free),
                            ground_.study.campaign());
    if (other.numbers().size() != composition.numbers().size()) {
      continue;
    }
    ModelFit found = begun_from(
        composition,
        carry(other, begin_near(ground_.candidates[i], ground_.directions[i], other, worker),
              composition),
        nullptr, worker);
    better_of(fit, std::move(found));
  }
}

Refit Refitter::described(std::size_t index, const Model& model, Composition composition,
                          ModelFit fit, std::size_t worker) const {
  const Candidate& candidate = ground_.candidates[index];
  const Misfit misfit = misfit_of(ground_.study.residuals(), fit.residual,
                                  fit.degrees_of_freedom(composition), worker);
  Refit out{index,
            {fitted(model, composition, fit), std::move(composition), std::move(fit), misfit}};
  const double freedom = ground_.base.fit.degrees_of_freedom(ground_.base.composition) -
                         out.studied.fit.degrees_of_freedom(out.studied.composition);
  out.freedom = candidate.frees_prior ? 1.0 : std::round(freedom);
  out.signs = freedom < 1.5 ? candidate.signs : Signs::both;
  out.scatter =
      scatter_over_noise(out.studied, candidate.id(), ground_.study.residuals().per_shot());
  out.chi2_in_base_noise =
      ground_.study.residuals()
          .evaluate_in_noise_of(ground_.base.composition, ground_.base.fit.theta,
                                out.studied.composition, out.studied.fit.theta, worker)
          .squaredNorm();
  out.products = product_test_of(out.studied, candidate.id(), ground_.study.campaign());
  return out;
}

Refit Refitter::refit_closely(Refit rough, std::size_t worker) const {
  const Model model =
      with(ground_.base.model, ground_.candidates[rough.candidate], Auxiliaries::free);
  Studied& studied = rough.studied;
  ModelFit fit = fit_model(studied.composition, ground_.study.residuals(), serial_on(worker),
                           studied.fit.theta);
  return described(rough.candidate, model, std::move(studied.composition), std::move(fit), worker);
}

}  // namespace kolsky

#include "processing/criticism/fitting/study.hpp"

#include <algorithm>
#include <utility>

#include "processing/criticism/fitting/astray.hpp"
#include "processing/criticism/fitting/branch_order.hpp"
#include "processing/criticism/fitting/effect_starts.hpp"
#include "processing/criticism/fitting/moduli_starts.hpp"
#include "processing/criticism/fitting/statistics.hpp"

namespace kolsky {

Study::Study(const Campaign& campaign, double band_limit_Hz, Workers executor)
    : campaign_(campaign),
      executor_(std::move(executor)),
      residuals_(campaign, band_limit_Hz, executor_.workers) {}

Model Study::begun(Model model) {
  start_moduli(model, campaign_, residuals_);
  model = at_best_starts(std::move(model), campaign_, [&](const Composition& trial, bool first) {
    if (first) {
      residuals_.freeze(trial, trial.start());
    }
    return fit_model(trial, residuals_, executor_).objective();
  });
  // With what was added where it begins: without, the specimen's moduli may be nowhere.
  start_branch(model, campaign_, residuals_, executor_);
  return model;
}

Study::Attempt Study::attempt(const Model& model) {
  Model started = begun(model);
  Composition composition(started, campaign_);
  residuals_.freeze(composition, composition.start());
  ModelFit fit = fit_model(composition, residuals_, executor_);
  residuals_.freeze(composition, fit.theta);
  fit = fit_model(composition, residuals_, executor_, fit.theta);
  return {std::move(started), std::move(composition), std::move(fit)};
}

Study::Attempt Study::best_attempt(const Model& model) {
  Attempt first = attempt(model);
  const Misfit misfit =
      misfit_of(residuals_, first.fit.residual, first.fit.degrees_of_freedom(first.composition));
  const std::optional<Model> unfitted = begun_afresh(model);
  if (!unfitted || !astray(fitted(first.begun, first.composition, first.fit), misfit)) {
    return first;
  }
  Attempt afresh = attempt(*unfitted);
  // Both by the same noise, then each by its own.
  residuals_.freeze(first.composition, first.fit.theta);
  const ModelFit beside = fit_model(afresh.composition, residuals_, executor_, afresh.fit.theta);
  Attempt& better = beside.objective() < first.fit.objective() ? afresh : first;
  residuals_.freeze(better.composition, better.fit.theta);
  better.fit = fit_model(better.composition, residuals_, executor_, better.fit.theta);
  return std::move(better);
}

Model Study::formed(Model model) {
  constexpr double kShotsDisagree = -6.9;  // ln of one in a thousand, were all of one strength
  for (EffectUse& use : model.effects) {
    if (!std::exchange(use.form_open, false) || campaign_.shots.size() < 2) {
      continue;
    }
    Attempt shared = best_attempt(model);
    use.per_shot = true;
    const Attempt own = best_attempt(model);
    // By one noise, that which the richer of both leaves.
    const ModelFit beside = fit_model(shared.composition, residuals_, executor_, shared.fit.theta);
    const auto more = static_cast<double>(own.fit.theta.size() - shared.fit.theta.size());
    const double gain = beside.objective() - own.fit.objective();
    use.per_shot = log_chi2_tail(std::max(0.0, gain), more) < kShotsDisagree;
  }
  return model;
}

Studied Study::fit(const Model& model, LearnNoise learn) {
  auto [started, composition, fit] = best_attempt(formed(model));
  if (learn == LearnNoise::yes) {
    residuals_.calibrate(composition, fit.theta);
    fit = fit_model(composition, residuals_, executor_, fit.theta);
  }
  if (put_branches_in_order(composition, fit.theta)) {
    fit = fit_model(composition, residuals_, executor_, fit.theta);
  }
  const Misfit misfit = misfit_of(residuals_, fit.residual, fit.degrees_of_freedom(composition));
  Model after = fitted(started, composition, fit);
  return {std::move(after), std::move(composition), std::move(fit), misfit};
}

Studied Study::refit(const Studied& studied) {
  residuals_.freeze(studied.composition, studied.fit.theta);
  ModelFit fit = fit_model(studied.composition, residuals_, executor_, studied.fit.theta);
  if (put_branches_in_order(studied.composition, fit.theta)) {
    fit = fit_model(studied.composition, residuals_, executor_, fit.theta);
  }
  const Misfit misfit =
      misfit_of(residuals_, fit.residual, fit.degrees_of_freedom(studied.composition));
  Model after = fitted(studied.model, studied.composition, fit);
  return {std::move(after), studied.composition, std::move(fit), misfit};
}

Studied Study::with_own_strengths(const Model& model) {
  Composition composition(all_but_own_held(model, campaign_.bench), campaign_);
  ModelFit fit;
  fit.theta = composition.start();
  fit.converged = true;
  if (!fit.theta.empty()) {
    residuals_.believe_quiet();
    residuals_.freeze(composition, fit.theta);
    fit = fit_model(composition, residuals_, executor_);
  }
  return {model, std::move(composition), std::move(fit), {}};
}

Studied Study::beside_quiet(Studied studied, const Studied* humming) {
  const Composition& composition = studied.composition;
  ModelFit& fit = studied.fit;
  residuals_.believe_quiet();
  residuals_.freeze(composition, fit.theta);
  if (campaign_.shots.size() > 1) {
    const Studied& shows = humming != nullptr ? *humming : studied;
    residuals_.calibrate(shows.composition, shows.fit.theta, NoiseShown::what_quiet_hides);
  }
  if (residuals_.know_steps() || humming != nullptr) {
    residuals_.freeze(composition, fit.theta);
  }
  fit.residual = residuals_.evaluate(composition, fit.theta);
  fit.chi2 = fit.residual.squaredNorm();
  const double freedom = fit.covariance.size() > 0 ? fit.degrees_of_freedom(composition)
                                                   : static_cast<double>(fit.residual.size());
  studied.misfit = misfit_of(residuals_, fit.residual, freedom);
  return studied;
}

}  // namespace kolsky

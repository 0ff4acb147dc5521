#include "processing/criticism/study.hpp"

#include <cmath>

#include "processing/criticism/branch_order.hpp"

namespace kolsky {

namespace {

/// All strengths of an effect are at null: its auxiliary parameters mean nothing yet.
bool is_null(const EffectUse& use) {
  const std::vector<EffectParameter>& parameters = use.effect->about().parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (!parameters[p].auxiliary() && use.values[p].value != parameters[p].null_value) {
      return false;
    }
  }
  return true;
}

}  // namespace

Study::Study(const Campaign& campaign, double band_limit_Hz, Workers executor)
    : campaign_(campaign),
      executor_(std::move(executor)),
      residuals_(campaign, band_limit_Hz, executor_.workers) {}

Model Study::begun(Model model) {
  start_moduli(model, campaign_, residuals_);
  for (std::size_t u = 0; u < model.effects.size(); ++u) {
    const std::vector<EffectParameter>& parameters = model.effects[u].effect->about().parameters;
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const bool at_null = is_null(model.effects[u]);
      const bool auxiliary = parameters[p].auxiliary();
      if (!model.effects[u].values[p].free || (!at_null && !(auxiliary && parameters[p].chosen))) {
        continue;
      }
      if (auxiliary) {
        model = best_of(model, u, p, parameters[p].starts);
      } else if (parameters[p].power != 1.0) {
        // First order at null says nothing of a large one.
        const double size = parameters[p].typical;
        model = best_of(model, u, p, {0.0, 2.0 * size, 4.0 * size, 8.0 * size, 16.0 * size});
      }
    }
  }
  return model;
}

Model Study::best_of(Model model, std::size_t use, std::size_t parameter,
                     const std::vector<double>& starts) {
  Model best = model;
  double least = HUGE_VAL;
  for (const double start : starts) {
    ModelValue& value = model.effects[use].values[parameter];
    value.value = start;
    value.free = !model.effects[use].effect->about().parameters[parameter].chosen;
    const Composition composition(model, campaign_);
    if (least == HUGE_VAL) {
      residuals_.freeze(composition, composition.start());
    }
    const double objective = fit_model(composition, residuals_, executor_).objective();
    if (objective < least) {
      least = objective;
      best = model;
    }
  }
  return best;
}

Studied Study::fit(const Model& model, LearnNoise learn) {
  const Model started = begun(model);
  Composition composition(started, campaign_);
  residuals_.freeze(composition, composition.start());
  ModelFit fit = fit_model(composition, residuals_, executor_);
  residuals_.freeze(composition, fit.theta);
  fit = fit_model(composition, residuals_, executor_, fit.theta);
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

Studied Study::as_it_is(const Model& model) {
  Composition composition(model, campaign_);
  ModelFit fit;
  fit.theta = composition.start();
  residuals_.freeze(composition, fit.theta);
  fit.residual = residuals_.evaluate(composition, fit.theta);
  fit.chi2 = fit.residual.squaredNorm();
  fit.converged = true;
  const Misfit misfit =
      misfit_of(residuals_, fit.residual, static_cast<double>(fit.residual.size()));
  return {model, std::move(composition), std::move(fit), misfit};
}

}  // namespace kolsky

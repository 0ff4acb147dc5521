#include "processing/criticism/verdict/refits.hpp"

#include <algorithm>
#include <utility>

#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

Studied begun_at(Study& study, const Model& model, std::vector<double> theta) {
  Composition composition(model, study.campaign());
  ModelFit fit = fit_model(composition, study.residuals(), study.executor(), std::move(theta));
  const Misfit misfit =
      misfit_of(study.residuals(), fit.residual, fit.degrees_of_freedom(composition));
  Model after = fitted(model, composition, fit);
  return {std::move(after), std::move(composition), std::move(fit), misfit};
}

Studied changed(Study& study, const Studied& current, const Model& model) {
  const Composition composition(model, study.campaign());
  return begun_at(study, model, carry(current.composition, current.fit.theta, composition));
}

Model model_without(const Studied& current, const std::string& id) {
  Model model = current.model;
  std::erase_if(model.effects, [&](const EffectUse& use) { return use.id() == id; });
  return model;
}

Studied without(Study& study, const Studied& current, const std::string& id) {
  return changed(study, current, model_without(current, id));
}

double evidence(const Studied& without, const Studied& with, double noise) {
  const double gain = (without.fit.objective() - with.fit.objective()) / noise;
  const double freedom = without.fit.degrees_of_freedom(without.composition) -
                         with.fit.degrees_of_freedom(with.composition);
  return equivalent_square(log_gain_tail(gain, std::max(1.0, freedom), Signs::both));
}

bool missed_in(const Study& study, const Studied& left, const Studied& current) {
  constexpr double kMissed = 16.0;  // as a square of a normal deviate
  const double noise = noise_of(current.misfit, study.campaign().shots.size());
  return evidence(left, current, noise) >= kMissed;
}

double repeated_excess(const Study& study, const Studied& studied) {
  const Misfit& misfit = studied.misfit;
  const double noise = noise_of(misfit, study.campaign().shots.size());
  return (misfit.chi2_reduced / noise - 1.0) * misfit.degrees_of_freedom;
}

}  // namespace kolsky

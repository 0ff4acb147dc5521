#include "processing/criticism/impact/impact_study.hpp"

#include <algorithm>
#include <cmath>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"
#include "processing/criticism/fitting/effect_starts.hpp"
#include "processing/criticism/fitting/held_out.hpp"
#include "processing/criticism/fitting/statistics.hpp"
#include "processing/criticism/search/candidates.hpp"

namespace kolsky {

namespace {

/// Whether a fit that began elsewhere came to the minimum of this one, as far as coarse forces
/// tell: 2 to 18 of squared deviations lay between them where it did, 86 and more where it did not.
bool same_minimum(const ModelFit& fit, const std::vector<double>& other) {
  constexpr double kNear = 30.0;
  const auto size = static_cast<Eigen::Index>(fit.theta.size());
  const Eigen::VectorXd apart = Eigen::Map<const Eigen::VectorXd>(other.data(), size) -
                                Eigen::Map<const Eigen::VectorXd>(fit.theta.data(), size);
  return apart.dot(fit.information * apart) < kNear;
}

}  // namespace

bool strained(const Composition& composition, const std::vector<double>& theta) {
  constexpr double kFar = 1.9;
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    if (number.prior_sd > 0.0 &&
        std::abs(number.value_at(theta[i]) - number.prior_mean) > kFar * number.prior_sd) {
      return true;
    }
  }
  return false;
}

std::vector<double> as_filed(const Composition& composition, std::vector<double> theta) {
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    theta[i] = number.prior_sd > 0.0 ? number.theta_of(number.prior_mean) : theta[i];
  }
  return theta;
}

Studied ImpactStudy::finish(const Model& model, Composition composition, ModelFit fit) const {
  const double used =
      static_cast<double>(fit.residual.size()) - fit.degrees_of_freedom(composition);
  const Misfit misfit = misfit_of(fit.residual, used);
  if (fit.covariance.size() > 0) {
    fit.doubt = residuals_.doubt_of(fit.jacobian, fit.covariance);
    if (second_minimum_ && second_minimum_->theta.size() == fit.theta.size()) {
      // Two minima: the covariance of a mixture, each by what its squares count.
      const double here = 1.0 / (1.0 + std::exp(-0.5 * second_minimum_->behind / kSolverDoubt));
      const Eigen::VectorXd apart =
          Eigen::Map<const Eigen::VectorXd>(second_minimum_->theta.data(), fit.doubt.rows()) -
          Eigen::Map<const Eigen::VectorXd>(fit.theta.data(), fit.doubt.rows());
      fit.doubt += here * (1.0 - here) * apart * apart.transpose();
    }
  }
  Model after = fitted(model, composition, fit);
  return {std::move(after), std::move(composition), std::move(fit), misfit};
}

std::string name_of(Allowance allowance) {
  switch (allowance) {
    case Allowance::kept:
      return "kept";
    case Allowance::mimicked:
      return "mimicked";
    case Allowance::exceeded:
      return "exceeded";
  }
  return {};
}

JudgedStretch judged_stretch(const Model& model) {
  return model.find("end-reflection") != nullptr ? JudgedStretch::whole
                                                 : JudgedStretch::to_reflection;
}

/// A ball with little friction has a second minimum where friction is filed, with moduli and law in
/// its place, and coarse forces do not lead from there to the other. Nor does anything there have
/// to be strained. So the two are compared, each with forces that were taken where it is
/// (docs/impact.md).
ModelFit ImpactStudy::or_with_little_friction(const Model& model, const Composition& composition,
                                              ModelFit fit) {
  const EffectUse* friction = model.find("contact-friction");
  const bool filed =
      friction != nullptr && friction->values[0].free && friction->values[0].prior_sd > 0.0;
  if (!filed) {
    return fit;
  }
  const auto again_at = [&](const std::vector<double>& theta, Settle settle) {
    const std::vector<double> near =
        anchor_near(composition, theta, ImpactResiduals::AnchorBy::middle);
    return fit_by_secants(composition, residuals_, executor_, near, nullptr, settle);
  };
  constexpr double kFiledDeviations = 3.0;
  const ModelValue& mu = friction->values[0];
  std::size_t own = 0;
  while (composition.uses()[composition.numbers()[own].use].id() != friction->id()) {
    ++own;
  }
  const FreeNumber& number = composition.numbers()[own];
  std::vector<double> little = composition.start();
  little[own] = number.inside(number.theta_of(mu.prior_mean - kFiledDeviations * mu.prior_sd));
  const ModelFit near = again_at(fit.theta, Settle::fully);
  const ModelFit other = again_at(again_at(little, Settle::roughly).theta, Settle::fully);
  const double ahead = near.objective() - other.objective();
  if (!std::isfinite(ahead)) {
    residuals_.anchor(composition, composition.start());
    return fit;
  }
  constexpr double kElsewhere = 2.0;  ///< of chi2: more than forces are rough by
  const bool moves = ahead > kElsewhere;
  const std::vector<double>& left = moves ? near.theta : other.theta;
  constexpr double kSame = 0.5;  ///< of what is filed: the same minimum, come to from elsewhere
  if (std::abs(number.value_at(other.theta[own]) - number.value_at(near.theta[own])) >
      kSame * mu.prior_sd) {
    second_minimum_ = SecondMinimum{left, number.value_at(left[own]), std::abs(ahead)};
  }
  static_cast<void>(anchor_near(composition, moves ? other.theta : composition.start(),
                                ImpactResiduals::AnchorBy::fine));
  return moves ? other : fit;
}

Studied ImpactStudy::fit(const Model& begun) {
  const Model model =
      at_best_starts(begun, campaign_, [&](const Composition& composition, bool first) {
        if (first) {
          residuals_.prepare(composition, composition.start());
        }
        return fit_by_secants(composition, residuals_, executor_).objective();
      });
  Composition composition(model, campaign_);
  second_minimum_.reset();
  residuals_.prepare(composition, composition.start());
  ModelFit fit = or_with_little_friction(model, composition,
                                         fit_by_secants(composition, residuals_, executor_));
  residuals_.calibrate(composition, fit.theta);
  fit = to_the_end(composition, fit.theta, nullptr, Settle::fully);
  return finish(model, std::move(composition), std::move(fit));
}

bool ImpactStudy::astray(const Composition& composition, const ModelFit& fit) const {
  const auto [chi2, freedom] = repeated(fit.residual);
  return strained(composition, fit.theta) || log_chi2_tail(chi2, freedom) < kUnexplained;
}

/// By what the middle mesh makes of each number, again until forces taken where that leads are what
/// it foretold of them. A search from there goes by the coarse mesh again.
ModelFit ImpactStudy::to_the_end(const Composition& composition, std::vector<double> theta,
                                 const Eigen::MatrixXd* chord, Settle settle) {
  constexpr int kMostPasses = 3;
  constexpr double kArrived = 2.0;  ///< of chi2: more than forces are rough by
  constexpr double kShare = 1e-2;   ///< of it: of a large misfit more is rough
  constexpr double kFarOff = 5.0;   ///< of noise: what leaves more is not what is said in the end
  using AnchorBy = ImpactResiduals::AnchorBy;
  using Moves = ImpactResiduals::Moves;
  const bool roughly = settle == Settle::roughly;
  ModelFit fit;
  bool arrived = false;
  for (int pass = 0; pass < kMostPasses && !arrived; ++pass) {
    theta = anchor_near(composition, theta, roughly ? AnchorBy::middle : AnchorBy::fine);
    const auto [chi2, freedom] = repeated(residuals_.evaluate_on(executor_, composition, theta));
    if (chi2 < kFarOff * freedom) {
      residuals_.move_by(roughly ? Moves::middle_along_coarse : Moves::middle, composition);
    }
    const Eigen::MatrixXd before = fit.jacobian;
    fit = fit_by_secants(composition, residuals_, executor_, theta, pass > 0 ? &before : chord,
                         settle);
    theta = fit.theta;
    const double foretold = fit.chi2;
    stand_at(composition, fit);
    arrived = !(std::abs(fit.chi2 - foretold) > std::max(kArrived, kShare * fit.chi2));
  }
  return fit;
}

/// A model that lacks much goes to balls that finer meshes do not take (so soft that the patch
/// spreads over the bar's edge). Then forces are taken on the way from there to what is filed.
/// @return where
std::vector<double> ImpactStudy::anchor_near(const Composition& composition,
                                             std::vector<double> theta,
                                             ImpactResiduals::AnchorBy by) {
  constexpr int kMostSteps = 4;
  const std::vector<double> filed = as_filed(composition, theta);
  for (int step = 0;; ++step) {
    try {
      residuals_.anchor(composition, theta, by);
      return theta;
    } catch (const InputError&) {
      if (step == kMostSteps) {
        throw;
      }
      for (std::size_t i = 0; i < theta.size(); ++i) {
        theta[i] = 0.5 * (theta[i] + filed[i]);
      }
      if (step + 1 == kMostSteps) {
        theta = composition.start();
      }
    }
  }
}

/// With forces taken where a fit is, or by a fit to where they can be.
void ImpactStudy::stand_at(const Composition& composition, ModelFit& fit) {
  const std::vector<double> near =
      anchor_near(composition, fit.theta, ImpactResiduals::AnchorBy::middle);
  if (near != fit.theta) {
    fit = fit_by_secants(composition, residuals_, executor_, near, nullptr, Settle::roughly);
    fit.converged = false;
    return;
  }
  fit.residual = residuals_.evaluate_on(executor_, composition, fit.theta);
  fit.chi2 = fit.residual.squaredNorm();
}

Studied ImpactStudy::refit(const Model& model, const Workers& executor, Settle settle) {
  Composition composition(model, campaign_);
  ModelFit fit = fit_by_secants(composition, residuals_, executor, {}, nullptr, settle);
  return finish(model, std::move(composition), std::move(fit));
}

Studied ImpactStudy::refit_near(const Model& model, const Studied& other) {
  Composition composition(model, campaign_);
  ModelFit near = fit_by_secants(composition, residuals_, executor_,
                                 carry(other.composition, other.fit.theta, composition));
  ModelFit own = fit_by_secants(composition, residuals_, executor_);
  const bool better = !(near.objective() <= own.objective());
  return finish(model, std::move(composition), better ? std::move(own) : std::move(near));
}

Studied ImpactStudy::settled(const Studied& studied, Settle settle) {
  const Composition& composition = studied.composition;
  ModelFit fit = to_the_end(composition, studied.fit.theta, nullptr, settle);
  if (astray(composition, fit)) {
    const std::vector<double> filed = as_filed(composition, fit.theta);
    residuals_.anchor(composition, filed, ImpactResiduals::AnchorBy::middle);
    const ModelFit near = fit_by_secants(composition, residuals_, executor_, filed);
    std::optional<ModelFit> other;
    if (!same_minimum(fit, near.theta)) {
      other = to_the_end(composition, near.theta, &fit.jacobian, settle);
    }
    if (other && other->objective() < fit.objective()) {
      fit = std::move(*other);
    } else {
      stand_at(composition, fit);
    }
  }
  return finish(studied.model, composition, std::move(fit));
}

Studied ImpactStudy::polished(const Studied& settled) {
  ModelFit fit =
      to_the_end(settled.composition, settled.fit.theta, &settled.fit.jacobian, Settle::fully);
  return finish(settled.model, settled.composition, std::move(fit));
}

Studied ImpactStudy::by_coarse_mesh(const Studied& studied) {
  ModelFit fit = fit_by_secants(studied.composition, residuals_, executor_, studied.fit.theta);
  return finish(studied.model, studied.composition, std::move(fit));
}

Studied ImpactStudy::allowing(double share, const Studied& studied) {
  residuals_.allow(share, studied.composition, studied.fit.theta);
  return settled(studied, Settle::roughly);
}

Studied ImpactStudy::as_it_is(const Model& model) {
  Composition composition(all_but_own_held(model, campaign_.bench), campaign_);
  ModelFit fit;
  fit.theta = composition.start();
  fit.converged = true;
  residuals_.prepare(composition, fit.theta);
  residuals_.calibrate(composition, fit.theta);
  if (!fit.theta.empty()) {
    fit = fit_by_secants(composition, residuals_, executor_);
    residuals_.calibrate(composition, fit.theta);
    fit = fit_by_secants(composition, residuals_, executor_, fit.theta);
  }
  fit.residual = residuals_.evaluate(composition, fit.theta, executor_.first);
  fit.chi2 = fit.residual.squaredNorm();
  const double used = fit.covariance.size() > 0 ? static_cast<double>(fit.residual.size()) -
                                                      fit.degrees_of_freedom(composition)
                                                : 0.0;
  const Misfit misfit = misfit_of(fit.residual, used);
  return {model, std::move(composition), std::move(fit), misfit};
}

std::pair<double, double> ImpactStudy::repeated(const Eigen::VectorXd& white) const {
  const auto size = static_cast<Eigen::Index>(residuals_.per_shot());
  double chi2 = 0.0;
  for (const SpeedGroup& group : residuals_.records().groups) {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(size);
    for (const std::size_t n : group.shots) {
      mean += white.segment(static_cast<Eigen::Index>(n) * size, size);
    }
    chi2 += mean.squaredNorm() / static_cast<double>(group.shots.size());
  }
  return {chi2, repeated_freedom()};
}

double ImpactStudy::unexplained_log_p(const Eigen::VectorXd& white) const {
  const auto [chi2, freedom] = repeated(white);
  const auto [of_rebounds, rebounds] = repeated_of_rebounds(white);
  return std::min(log_chi2_tail(chi2 / kSolverDoubt, freedom),
                  log_chi2_tail(of_rebounds, rebounds));
}

std::pair<double, double> ImpactStudy::repeated_of_rebounds(const Eigen::VectorXd& white) const {
  const ImpactRecords& records = residuals_.records();
  std::vector<Eigen::Index> said;
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    if (records.unsaid_rebounds(g) < records.groups[g].shots.size()) {
      said.push_back(static_cast<Eigen::Index>((g + 1) * residuals_.per_shot() - 1));
    }
  }
  if (said.empty()) {
    return {0.0, 1.0};
  }
  const ImpactWhitening& whitening = residuals_.whitening();
  const Eigen::VectorXd off = whitening.means_behind(white)(said);
  const Eigen::MatrixXd covariance = whitening.of_means()(said, said);
  return {off.dot(inverse_of(covariance) * off), static_cast<double>(said.size())};
}

bool ImpactStudy::within_calculation(const Eigen::VectorXd& white) const {
  return !(unexplained_log_p(white) < kUnexplained);
}

Allowance ImpactStudy::allowance(const Studied& studied) const {
  return studied.misfit.repeatable_log_p >= kUnexplained ? Allowance::kept
         : within_calculation(studied.fit.residual)      ? Allowance::mimicked
                                                         : Allowance::exceeded;
}

Misfit ImpactStudy::misfit_of(const Eigen::VectorXd& white, double used) const {
  Misfit misfit;
  const double all = known();
  misfit.degrees_of_freedom = std::max(1.0, all - used);
  misfit.chi2_reduced = white.squaredNorm() / misfit.degrees_of_freedom;
  const auto [chi2, freedom] = repeated(white);
  misfit.noise_scale = all > freedom ? (white.squaredNorm() - chi2) / (all - freedom) : 1.0;
  const ImpactEnergy& energy = residuals_.energy();
  misfit.repeatable_share =
      energy.repeated(residuals_.whitening().means_behind(white)) / energy.signal();
  misfit.noise_floor_share = energy.noise() / energy.signal();
  misfit.repeatable_log_p = log_chi2_tail(chi2 / std::max(1.0, misfit.noise_scale), freedom);
  return misfit;
}

double ImpactStudy::known() const {
  const auto shots = static_cast<double>(campaign_.shots.size());
  return shots * (static_cast<double>(residuals_.per_shot()) - residuals_.eliminated()) -
         static_cast<double>(residuals_.records().unsaid_rebounds());
}

double ImpactStudy::repeated_freedom() const {
  const ImpactRecords& records = residuals_.records();
  double freedom = 0.0;
  for (std::size_t g = 0; g < records.groups.size(); ++g) {
    freedom += static_cast<double>(residuals_.per_shot()) - residuals_.eliminated() -
               (records.unsaid_rebounds(g) == records.groups[g].shots.size() ? 1.0 : 0.0);
  }
  return freedom;
}

std::vector<double> held_out_speeds(const Studied& studied, const ImpactRecords& records,
                                    std::size_t per_shot) {
  std::vector<std::vector<std::size_t>> folds;
  for (const SpeedGroup& group : records.groups) {
    folds.push_back(group.shots);
  }
  return held_out_squares(studied, per_shot, folds);
}

}  // namespace kolsky

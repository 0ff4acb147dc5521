#include "processing/criticism/fitting/fit_steps.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "processing/algebra/algebra.hpp"
#include "processing/criticism/fitting/astray.hpp"

namespace kolsky {

namespace {

/// How far theta is from the middle of the priors, in scales.
Eigen::VectorXd from_priors(const Composition& composition, const std::vector<double>& theta) {
  Eigen::VectorXd off(static_cast<Eigen::Index>(theta.size()));
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    off[static_cast<Eigen::Index>(i)] = theta[i] - number.theta_of(number.prior_mean);
  }
  return off;
}

double penalty_of(const Composition& composition, const Eigen::MatrixXd& precision,
                  const std::vector<double>& theta) {
  const Eigen::VectorXd off = from_priors(composition, theta);
  return off.dot(precision * off);
}

void keep_inside(const Composition& composition, std::vector<double>& theta) {
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const FreeNumber& number = composition.numbers()[i];
    theta[i] = number.inside(theta[i]);
  }
}

constexpr double kRounding = 1e-12;  ///< share of an information
/// Less than that of the most makes rounding of a number's derivatives.
constexpr double kHardlyAny = 1e-8;

/// By which each number's information is reckoned: its own, whatever its unit makes of it; or that
/// of what the records tell most of.
Eigen::VectorXd own_information(const Eigen::MatrixXd& information, bool alike) {
  const double most = information.diagonal().maxCoeff();
  const double least = alike ? most : kHardlyAny * most;
  return information.diagonal().cwiseMax(std::max(least, std::numeric_limits<double>::min()));
}

/// The inverse of the information. Where neither data nor priors tell numbers apart, or one from
/// nothing, the inverse is as large as rounding leaves it.
Eigen::MatrixXd covariance_of(const Eigen::MatrixXd& information, bool alike) {
  const Eigen::VectorXd unit = own_information(information, alike).cwiseSqrt().cwiseInverse();
  const SymmetricEigen solver(unit.asDiagonal() * information * unit.asDiagonal());
  const Eigen::MatrixXd vectors = unit.asDiagonal() * solver.eigenvectors();
  return vectors * solver.eigenvalues().cwiseMax(0.1 * kRounding).cwiseInverse().asDiagonal() *
         vectors.transpose();
}

bool at_bound(const FreeNumber& number, double theta, double downhill) {
  const double value = number.value_at(theta);
  const double reach = 1e-9 * (number.upper - number.lower);
  return (value <= number.lower + reach && downhill < 0.0) ||
         (value >= number.upper - reach && downhill > 0.0);
}

}  // namespace

FitSteps::FitSteps(const Composition& composition, ShotResiduals& residuals,
                   const Workers& executor, std::vector<double> start)
    : composition_(composition),
      residuals_(residuals),
      executor_(executor),
      precision_(composition.prior_precision()) {
  fit_.theta = start.empty() ? composition.start() : std::move(start);
  keep_inside(composition, fit_.theta);
  fit_.residual = residuals.evaluate_on(executor, composition, fit_.theta);
  fit_.chi2 = fit_.residual.squaredNorm();
  fit_.penalty = penalty_of(composition, precision_, fit_.theta);
}

bool FitSteps::Step::better() const {
  return std::isfinite(chi2) && gain > -1e-6;
}

void FitSteps::derive() {
  std::vector<std::size_t> all(fit_.theta.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  fit_.jacobian = derivatives(composition_, residuals_, fit_.theta, fit_.residual, all, executor_);
  linearise();
}

void FitSteps::borrow(const Eigen::MatrixXd& jacobian) {
  fit_.jacobian = jacobian;
  linearise();
}

void FitSteps::learn(const Step& step) {
  Eigen::VectorXd moved(static_cast<Eigen::Index>(step.theta.size()));
  for (std::size_t i = 0; i < step.theta.size(); ++i) {
    moved[static_cast<Eigen::Index>(i)] = step.theta[i] - fit_.theta[i];
  }
  const Eigen::VectorXd weighted = fit_.information.diagonal().cwiseProduct(moved);
  const double length = weighted.dot(moved);
  if (length > 0.0 && step.residual.allFinite()) {
    const Eigen::VectorXd unforeseen = step.residual - fit_.residual - fit_.jacobian * moved;
    fit_.jacobian += unforeseen * (weighted / length).transpose();
  }
}

void FitSteps::linearise() {
  const auto count = static_cast<Eigen::Index>(fit_.theta.size());
  fit_.information = fit_.jacobian.transpose() * fit_.jacobian;
  downhill_ = -fit_.jacobian.transpose() * fit_.residual;
  fit_.information += precision_;
  downhill_ -= precision_ * from_priors(composition_, fit_.theta);
  // A number that is held by its bound takes no part in this step.
  information_ = fit_.information;
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (at_bound(composition_.numbers()[at], fit_.theta[at], downhill_[i])) {
      downhill_[i] = 0.0;
      information_.row(i).setZero();
      information_.col(i).setZero();
      information_(i, i) = 1.0;
    }
  }
  const Eigen::VectorXd move = move_inside(information_);
  promised_ = move.dot(2.0 * downhill_ - information_ * move);
}

/// The step to the least of the parabola within the bounds.
Eigen::VectorXd FitSteps::move_inside(const Eigen::MatrixXd& information) const {
  const Eigen::VectorXd move = solve_symmetric(information, downhill_);
  Eigen::VectorXd low(move.size());
  Eigen::VectorXd high(move.size());
  bool leaves = false;
  for (Eigen::Index i = 0; i < move.size(); ++i) {
    const FreeNumber& number = composition_.numbers()[static_cast<std::size_t>(i)];
    const double theta = fit_.theta[static_cast<std::size_t>(i)];
    low[i] = std::min(0.0, number.theta_of(number.lower) - theta);
    high[i] = std::max(0.0, number.theta_of(number.upper) - theta);
    leaves = leaves || move[i] < low[i] || move[i] > high[i];
  }
  return leaves ? least_in_box(information, downhill_, low, high) : move;
}

bool FitSteps::holds_weak() const {
  return chi2_per_residual() > kFarOff || residuals_.least_difference() > 0.0;
}

FitSteps::Step FitSteps::tried(double damping) {
  const auto count = static_cast<Eigen::Index>(fit_.theta.size());
  Eigen::MatrixXd damped = information_;
  damped.diagonal() +=
      damping * information_.diagonal() + kRounding * own_information(information_, holds_weak());
  const Eigen::VectorXd move = move_inside(damped);
  std::vector<double> theta = fit_.theta;
  for (Eigen::Index i = 0; i < count; ++i) {
    theta[static_cast<std::size_t>(i)] += move[i];
  }
  keep_inside(composition_, theta);
  Step step = at(std::move(theta));
  step.foretold = move.dot(2.0 * downhill_ - information_ * move);
  return step;
}

FitSteps::Step FitSteps::at(std::vector<double> theta) {
  Step step;
  step.theta = std::move(theta);
  step.residual = residuals_.evaluate_on(executor_, composition_, step.theta);
  step.chi2 = step.residual.squaredNorm();
  step.penalty = penalty_of(composition_, precision_, step.theta);
  step.gain = fit_.objective() - step.chi2 - step.penalty;
  return step;
}

void FitSteps::take(Step step) {
  fit_.theta = std::move(step.theta);
  fit_.residual = std::move(step.residual);
  fit_.chi2 = step.chi2;
  fit_.penalty = step.penalty;
}

ModelFit FitSteps::done(bool converged) {
  fit_.converged = converged;
  fit_.taken_by_noise = residuals_.taken_by_noise(composition_, fit_.theta, executor_.first);
  fit_.covariance = covariance_of(fit_.information, holds_weak());
  return std::move(fit_);
}

ModelFit FitSteps::as_it_is() {
  fit_.converged = true;
  fit_.taken_by_noise = residuals_.taken_by_noise(composition_, fit_.theta, executor_.first);
  fit_.jacobian.resize(fit_.residual.size(), 0);
  fit_.covariance.resize(0, 0);
  return std::move(fit_);
}

}  // namespace kolsky

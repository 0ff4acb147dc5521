#include "processing/specimen/specimen_search.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr int kMostSteps = 60;
constexpr double kParameterStep = 1e-3;  // relative: parameters are logarithms
constexpr double kMoveStep = 0.05;       // standard deviations
constexpr double kLongestStep = 1.5;     // of a logarithm
constexpr double kDone = 1e-3;           // of chi2: far below what one deviation changes

/// A solid of the family near the three-element one with these numbers.
std::vector<double> near_three_element(SolidKind kind, double E1, double E2, double tau_s) {
  const double eta = E2 * tau_s;
  switch (kind) {
    case SolidKind::three_element:
      return {E1, E2, eta};
    case SolidKind::four_element_fluid:
      return {E1, 1e2 * eta, E2, eta};
    case SolidKind::two_kelvin:
      return {E1, 2.0 * E2, eta, 2.0 * E2, 10.0 * eta};
    case SolidKind::fractional:
      break;
  }
  return {E1, E2, eta, 0.9};
}

}  // namespace

SpecimenSearch::SpecimenSearch(SpecimenLikelihood& likelihood, SolidKind solid, ShpbTheory theory)
    : likelihood_(likelihood),
      solid_(solid),
      theory_(theory),
      solids_(static_cast<Eigen::Index>(parameters_of(solid).size())) {}

SpecimenSearch::Point SpecimenSearch::point(const Eigen::VectorXd& x) const {
  Point p;
  for (Eigen::Index i = 0; i < solids_; ++i) {
    p.parameters.push_back(std::exp(x[i]));
  }
  p.moves.assign(x.data() + solids_, x.data() + x.size());
  return p;
}

Eigen::MatrixXd SpecimenSearch::root(const Eigen::VectorXd& x) {
  const Point p = point(x);
  return likelihood_.covariance_root(theory_, *make_solid(solid_, p.parameters), p.moves);
}

/// Whitened, with the moves themselves (their priors) at the end.
Eigen::VectorXd SpecimenSearch::residuals(const Eigen::VectorXd& x, const Eigen::MatrixXd& root) {
  const Point p = point(x);
  likelihood_.residuals(theory_, *make_solid(solid_, p.parameters), p.moves, raw_);
  root.triangularView<Eigen::Lower>().solveInPlace(raw_);
  const Eigen::Index moves = x.size() - solids_;
  Eigen::VectorXd out(raw_.size() + moves);
  out.head(raw_.size()) = raw_.reshaped();
  out.tail(moves) = x.tail(moves);
  return out;
}

Eigen::MatrixXd SpecimenSearch::jacobian(const Eigen::VectorXd& x, const Eigen::MatrixXd& root) {
  Eigen::MatrixXd result;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double step = i < solids_ ? kParameterStep : kMoveStep;
    Eigen::VectorXd moved = x;
    moved[i] = x[i] + step;
    const Eigen::VectorXd after = residuals(moved, root);
    moved[i] = x[i] - step;
    const Eigen::VectorXd before = residuals(moved, root);
    if (result.size() == 0) {
      result.resize(after.size(), x.size());
    }
    result.col(i) = (after - before) / (2.0 * step);
  }
  return result;
}

std::vector<double> SpecimenSearch::start() {
  const auto moves = static_cast<Eigen::Index>(likelihood_.unknowns().size());
  double best = std::numeric_limits<double>::infinity();
  std::vector<double> found;
  for (double E1 = 3e6; E1 < 1e12; E1 *= std::sqrt(10.0)) {
    for (const double share : {0.3, 1.0, 5.0}) {
      for (const double tau_s : {5e-6, 20e-6, 80e-6}) {
        const auto solid = near_three_element(solid_, E1, share * E1, tau_s);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(solids_ + moves);
        for (Eigen::Index i = 0; i < solids_; ++i) {
          x[i] = std::log(solid[static_cast<std::size_t>(i)]);
        }
        // Unweighted: all that is asked is where to begin.
        const Point p = point(x);
        likelihood_.residuals(theory_, *make_solid(solid_, p.parameters), p.moves, raw_);
        const double sum = raw_.squaredNorm();
        if (sum < best) {
          best = sum;
          found.assign(x.data(), x.data() + solids_);
        }
      }
    }
  }
  return found;
}

SpecimenMinimum SpecimenSearch::minimise(const std::vector<double>& start) {
  const auto moves = static_cast<Eigen::Index>(likelihood_.unknowns().size());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(solids_ + moves);
  std::copy(start.begin(), start.end(), x.data());
  double damping = 1e-2;
  Eigen::MatrixXd weights = root(x);
  Eigen::VectorXd r = residuals(x, weights);
  Eigen::MatrixXd J = jacobian(x, weights);
  bool converged = false;
  double last_gain = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps && !converged; ++step) {
    Eigen::MatrixXd normal = J.transpose() * J;
    const Eigen::VectorXd slope = J.transpose() * r;
    const Eigen::VectorXd scale = normal.diagonal();
    normal.diagonal() += damping * scale;
    Eigen::VectorXd change = -solve_symmetric(normal, slope);
    const double longest = change.head(solids_).cwiseAbs().maxCoeff();
    if (longest > kLongestStep) {
      change *= kLongestStep / longest;
    }
    const Eigen::VectorXd moved = x + change;
    const double gain = r.squaredNorm() - residuals(moved, weights).squaredNorm();
    if (!(gain >= 0.0)) {
      damping *= 10.0;
      converged = damping > 1e12;
      continue;
    }
    converged = gain < kDone && damping < 1.0;
    last_gain = gain;
    x = moved;
    damping = std::max(damping / 10.0, 1e-12);
    weights = root(x);
    r = residuals(x, weights);
    J = jacobian(x, weights);
  }
  // A parameter that the data do not hold drifts without end; its deviation says so.
  constexpr double kDrift = 0.1;
  if ((!converged && last_gain > kDrift) || !r.allFinite()) {
    throw InputError("fit", "does not converge",
                     "try another family of solids, a narrower band or a shorter window");
  }
  SpecimenMinimum minimum;
  minimum.parameters.assign(x.data(), x.data() + solids_);
  minimum.moves.assign(x.data() + solids_, x.data() + x.size());
  minimum.chi2 = r.squaredNorm();
  minimum.covariance = symmetric_inverse(J.transpose() * J);
  return minimum;
}

}  // namespace kolsky

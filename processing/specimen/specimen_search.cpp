#include "processing/specimen/specimen_search.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "processing/algebra/algebra.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr int kMostSteps = 60;
constexpr int kMostHeldSteps = 300;      // without weights to be taken they cost little
constexpr double kParameterStep = 1e-3;  // relative: parameters are logarithms
constexpr double kMoveStep = 0.05;       // standard deviations
constexpr double kLongestStep = 1.5;     // of a logarithm
constexpr double kDone = 1e-3;           // of chi2: far below what one deviation changes
constexpr double kUnknownLog = 5.0;      // deviation of a logarithm that nothing is known of
constexpr std::size_t kMostStarts = 5;
/// E2 over E1 of what counts as elastic, its time, and how tightly both are held.
constexpr double kUnseen = 1e6;
constexpr double kUnseenTime_s = 1e-5;
constexpr double kHeld = 1e-3;

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
    case SolidKind::three_kelvin:
      return {E1, 3.0 * E2, 0.3 * eta, 3.0 * E2, 3.0 * eta, 3.0 * E2, 30.0 * eta};
    case SolidKind::four_kelvin:
      return {E1,       4.0 * E2,   0.4 * eta, 4.0 * E2,   4.0 * eta,
              4.0 * E2, 40.0 * eta, 4.0 * E2,  400.0 * eta};
    case SolidKind::fractional:
      break;
  }
  return {E1, E2, eta, 0.9};
}

}  // namespace

SpecimenSearch::SpecimenSearch(SpecimenLikelihood& likelihood, SolidKind solid, ShpbTheory theory,
                               Loss loss)
    : likelihood_(likelihood),
      solid_(solid),
      theory_(theory),
      loss_(loss),
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

/// Whitened, with the moves themselves (their priors) at the end, and what holds a loss at none.
Eigen::VectorXd SpecimenSearch::residuals(const Eigen::VectorXd& x, const Eigen::MatrixXd& root) {
  const Point p = point(x);
  likelihood_.residuals(theory_, *make_solid(solid_, p.parameters), p.moves, raw_);
  root.triangularView<Eigen::Lower>().solveInPlace(raw_);
  const Eigen::Index moves = x.size() - solids_;
  const Eigen::Index held = loss_ == Loss::none ? 2 : 0;
  Eigen::VectorXd out(raw_.size() + moves + held);
  out.head(raw_.size()) = raw_.reshaped();
  out.segment(raw_.size(), moves) = x.tail(moves);
  if (loss_ == Loss::none) {
    out.tail(2) << (x[1] - x[0] - std::log(kUnseen)) / kHeld,
        (x[2] - x[1] - std::log(kUnseenTime_s)) / kHeld;
  }
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

double SpecimenSearch::plain_misfit(const Eigen::VectorXd& x) {
  const Point p = point(x);
  likelihood_.residuals(theory_, *make_solid(solid_, p.parameters), p.moves, raw_);
  return raw_.squaredNorm();
}

std::vector<std::vector<double>> SpecimenSearch::starts() {
  const auto moves = static_cast<Eigen::Index>(likelihood_.unknowns().size());
  std::vector<std::pair<double, std::vector<double>>> found;
  for (double E1 = 3e6; E1 < 1e12; E1 *= std::sqrt(10.0)) {
    std::pair<double, std::vector<double>> best{std::numeric_limits<double>::infinity(), {}};
    const bool lossless = loss_ == Loss::none;
    for (const double share : lossless ? std::vector{kUnseen} : std::vector{0.3, 1.0, 5.0}) {
      for (const double tau_s :
           lossless ? std::vector{kUnseenTime_s} : std::vector{5e-6, 20e-6, 80e-6}) {
        const auto solid = near_three_element(solid_, E1, share * E1, tau_s);
        Eigen::VectorXd x = Eigen::VectorXd::Zero(solids_ + moves);
        for (Eigen::Index i = 0; i < solids_; ++i) {
          x[i] = std::log(solid[static_cast<std::size_t>(i)]);
        }
        const double sum = plain_misfit(x);
        if (sum < best.first) {
          best = {sum, {x.data(), x.data() + solids_}};
        }
      }
    }
    if (!best.second.empty()) {
      found.push_back(std::move(best));
    }
  }
  std::sort(found.begin(), found.end());
  std::vector<std::vector<double>> list;
  for (std::size_t i = 0; i < std::min(kMostStarts, found.size()); ++i) {
    list.push_back(std::move(found[i].second));
  }
  return list;
}

SpecimenSearch::Place SpecimenSearch::place_at(const Eigen::VectorXd& x, Eigen::MatrixXd weights) {
  Place place{x, std::move(weights), {}, {}};
  place.r = residuals(place.x, place.weights);
  place.J = jacobian(place.x, place.weights);
  return place;
}

/// Damped, at most so long, and not beyond the bounds: a number at one that would go on stays.
Eigen::VectorXd SpecimenSearch::step_from(const Place& place, double damping,
                                          const LogBounds* bounds) const {
  Eigen::MatrixXd normal = place.J.transpose() * place.J;
  Eigen::VectorXd slope = place.J.transpose() * place.r;
  const Eigen::VectorXd scale = normal.diagonal();
  normal.diagonal() += damping * scale;
  for (Eigen::Index i = 0; bounds != nullptr && i < solids_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const bool stays = (place.x[i] >= bounds->upper[at] && slope[i] <= 0.0) ||
                       (place.x[i] <= bounds->lower[at] && slope[i] >= 0.0);
    if (stays) {
      normal.row(i).setZero();
      normal.col(i).setZero();
      normal(i, i) = 1.0;
      slope[i] = 0.0;
    }
  }
  Eigen::VectorXd change = -solve_symmetric(normal, slope);
  const double longest = change.head(solids_).cwiseAbs().maxCoeff();
  if (longest > kLongestStep) {
    change *= kLongestStep / longest;
  }
  for (Eigen::Index i = 0; bounds != nullptr && i < solids_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    change[i] =
        std::clamp(place.x[i] + change[i], bounds->lower[at], bounds->upper[at]) - place.x[i];
  }
  return change;
}

SpecimenSearch::Place SpecimenSearch::search(Place place, const LogBounds* bounds) {
  double damping = 1e-2;
  bool converged = false;
  double last_gain = std::numeric_limits<double>::infinity();
  const int most = bounds == nullptr ? kMostSteps : kMostHeldSteps;
  for (int step = 0; step < most && !converged; ++step) {
    const Eigen::VectorXd moved = place.x + step_from(place, damping, bounds);
    const double gain = place.r.squaredNorm() - residuals(moved, place.weights).squaredNorm();
    if (!(gain >= 0.0)) {
      damping *= 10.0;
      converged = damping > 1e12;
      continue;
    }
    converged = gain < kDone && damping < 1.0;
    last_gain = gain;
    damping = std::max(damping / 10.0, 1e-12);
    place = place_at(moved, bounds == nullptr ? root(moved) : std::move(place.weights));
  }
  // A parameter that the data do not hold drifts without end; its deviation says so.
  constexpr double kDrift = 0.1;
  if ((!converged && last_gain > kDrift) || !place.r.allFinite()) {
    throw InputError(
        "fit", "does not converge",
        "try a narrower band or a shorter window, shots whose pulse is shorter than the "
        "bars let wait for its answer, or another family of solids");
  }
  return place;
}

SpecimenMinimum SpecimenSearch::minimum_at(const Place& place) const {
  SpecimenMinimum minimum;
  minimum.parameters.assign(place.x.data(), place.x.data() + solids_);
  minimum.moves.assign(place.x.data() + solids_, place.x.data() + place.x.size());
  minimum.chi2 = place.r.squaredNorm();
  return minimum;
}

Eigen::VectorXd SpecimenSearch::joined(const std::vector<double>& parameters,
                                       const std::vector<double>& moves) const {
  Eigen::VectorXd x(solids_ + static_cast<Eigen::Index>(moves.size()));
  std::copy(parameters.begin(), parameters.end(), x.data());
  std::copy(moves.begin(), moves.end(), x.data() + solids_);
  return x;
}

SpecimenMinimum SpecimenSearch::minimise(const std::vector<double>& start) {
  const Eigen::VectorXd x = joined(start, std::vector<double>(likelihood_.unknowns().size(), 0.0));
  const Place place = search(place_at(x, root(x)), nullptr);
  SpecimenMinimum minimum = minimum_at(place);
  minimum.covariance = symmetric_inverse(place.J.transpose() * place.J);
  require_determined(minimum);
  return minimum;
}

/// A search that runs away along a number ends where that number changes nothing any more: its
/// deviation is then beyond all measure, or none at all where its information has vanished.
void SpecimenSearch::require_determined(const SpecimenMinimum& minimum) const {
  for (Eigen::Index i = 0; i < solids_; ++i) {
    const double variance = minimum.covariance(i, i);
    if (!(variance > 0.0 && variance < kUnknownLog * kUnknownLog)) {
      throw InputError(
          "fit",
          std::string("says nothing of ") +
              parameters_of(solid_)[static_cast<std::size_t>(i)].name + " where it ends",
          "check the bar model, give more shots or a wider band, bars that are not much shorter "
          "than the pulse, or try another family of solids");
    }
  }
}

Eigen::MatrixXd SpecimenSearch::weights_at(const SpecimenMinimum& place) {
  return root(joined(place.parameters, place.moves));
}

SpecimenMinimum SpecimenSearch::minimise_held(const std::vector<double>& start,
                                              const std::vector<double>& moves,
                                              const Eigen::MatrixXd& weights,
                                              const LogBounds& bounds) {
  const Place place = search(place_at(joined(start, moves), weights), &bounds);
  SpecimenMinimum minimum = minimum_at(place);
  Eigen::MatrixXd information = place.J.transpose() * place.J;
  information.diagonal().head(solids_).array() += 1.0 / (kUnknownLog * kUnknownLog);
  minimum.covariance = symmetric_inverse(information);
  return minimum;
}

}  // namespace kolsky

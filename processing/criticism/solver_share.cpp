#include "processing/criticism/solver_share.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "processing/algebra/algebra.hpp"

namespace kolsky {

namespace {

/// Means of white residuals in axes along which both what is counted and the solver's error are
/// uncorrelated: the covariance is 1 + growth x size there, size those of the error.
struct Axes {
  Eigen::VectorXd size;
  Eigen::MatrixXd residual;
  Eigen::MatrixXd numbers;
  std::vector<Eigen::VectorXd> strengths;
};

Axes axes_of(const ImpactWhitening& whitening, const ModelFit& base,
             const std::vector<Candidate>& candidates, const std::vector<Direction>& directions) {
  const SymmetricEigen solver(whitening.white_force_doubt());
  const auto turned = [&](const Eigen::MatrixXd& white) {
    return Eigen::MatrixXd(solver.eigenvectors().transpose() * whitening.means(white));
  };
  Axes axes{solver.eigenvalues().cwiseMax(0.0), turned(base.residual), turned(base.jacobian), {}};
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Direction& own = directions[i];
    if (own.freedom == 1.0 && own.columns.cols() == 1 && !candidates[i].frees_prior) {
      axes.strengths.emplace_back(turned(own.columns));
    }
  }
  return axes;
}

/// The same with the solver's error of another size, what the model's numbers take up taken off.
class Means {
 public:
  /// @param elsewhere  information on the numbers that is not in the means
  Means(const Axes& axes, const Eigen::MatrixXd& elsewhere, double growth)
      : variance_((1.0 + growth * axes.size.array()).matrix()),
        root_(variance_.cwiseSqrt().cwiseInverse()),
        numbers_(root_.asDiagonal() * axes.numbers),
        information_(numbers_.transpose() * numbers_ + elsewhere),
        known_(information_.eigenvalues().cwiseMax(1e-12 * information_.eigenvalues().maxCoeff())),
        rest_(without_numbers(root_.asDiagonal() * axes.residual.col(0))),
        squares_((root_.asDiagonal() * axes.residual.col(0)).dot(rest_)) {}

  /// Without any strength, the numbers integrated over.
  [[nodiscard]] double log_likelihood() const {
    return -0.5 * (variance_.array().log().sum() + known_.array().log().sum() + squares_);
  }

  /// What the means hold of a strength; none where the numbers take it up.
  [[nodiscard]] double information_on(const Eigen::VectorXd& strength) const {
    const Eigen::VectorXd own = root_.asDiagonal() * strength;
    const double held = own.dot(without_numbers(own));
    constexpr double kAbsorbed = 1e-6;
    return held > kAbsorbed * own.squaredNorm() ? held : 0.0;
  }
  /// chi2 that a strength takes off. @pre information_on it is not none
  [[nodiscard]] double gain_of(const Eigen::VectorXd& strength) const {
    return std::pow(rest_.dot(root_.asDiagonal() * strength), 2) / information_on(strength);
  }

 private:
  [[nodiscard]] Eigen::VectorXd without_numbers(const Eigen::VectorXd& own) const {
    const Eigen::VectorXd pull =
        information_.eigenvectors().transpose() * (numbers_.transpose() * own);
    return own - numbers_ * (information_.eigenvectors() * pull.cwiseQuotient(known_));
  }

  Eigen::VectorXd variance_;
  Eigen::VectorXd root_;
  Eigen::MatrixXd numbers_;
  SymmetricEigen information_;
  Eigen::VectorXd known_;
  Eigen::VectorXd rest_;
  double squares_;
};

/// ln of the likelihood with the strength beside the model that makes it largest, if any:
/// integrated over, as the numbers, in units of what is known of it with the error as allowed for
/// now.
double log_likelihood(const Axes& axes, const Means& now, const Means& other) {
  double best = 0.0;
  for (const Eigen::VectorXd& strength : axes.strengths) {
    const double usual = now.information_on(strength);
    const double held = other.information_on(strength);
    if (usual > 0.0 && held > 0.0) {
      best = std::max(best, other.gain_of(strength) - std::log(held / usual));
    }
  }
  return other.log_likelihood() + 0.5 * best;
}

}  // namespace

double largest_solver_share(const ImpactWhitening& whitening, const ModelFit& base,
                            const std::vector<Candidate>& candidates,
                            const std::vector<Direction>& directions) {
  if (base.jacobian.cols() == 0) {
    return 1.0;  // no fit: what is left is the model's as much as the calculation's
  }
  const Axes axes = axes_of(whitening, base, candidates, directions);
  const Eigen::MatrixXd elsewhere = base.information - axes.numbers.transpose() * axes.numbers;
  const Means now(axes, elsewhere, 0.0);
  constexpr double kStep = 1.05;
  constexpr double kLeast = 0.02;
  std::vector<double> likelihood;
  for (double share = 1.0; share > kLeast; share /= kStep) {
    likelihood.push_back(log_likelihood(axes, now, Means(axes, elsewhere, share * share - 1.0)));
  }
  // Where half the square of 1.645, one in twenty to one side, is missing to the likeliest.
  constexpr double kContradicted = 1.35;
  const double most = *std::max_element(likelihood.begin(), likelihood.end());
  const auto largest = std::find_if(likelihood.begin(), likelihood.end(),
                                    [&](double own) { return own > most - kContradicted; });
  // The step before is the first that they contradict.
  return std::pow(kStep, std::min(0.0, 1.0 - static_cast<double>(largest - likelihood.begin())));
}

}  // namespace kolsky

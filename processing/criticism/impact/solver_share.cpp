#include "processing/criticism/impact/solver_share.hpp"

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
  Eigen::MatrixXd strengths;  ///< of candidates, one beside the other
};

Axes axes_of(const ImpactWhitening& whitening, const ModelFit& base,
             const std::vector<Candidate>& candidates, const std::vector<Direction>& directions) {
  const SymmetricEigen solver(whitening.white_force_doubt());
  const auto turned = [&](const Eigen::MatrixXd& white) {
    return Eigen::MatrixXd(solver.eigenvectors().transpose() * whitening.means(white));
  };
  Axes axes{solver.eigenvalues().cwiseMax(0.0), turned(base.residual), turned(base.jacobian), {}};
  axes.strengths.resize(axes.size.size(), static_cast<Eigen::Index>(candidates.size()));
  Eigen::Index count = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Direction& own = directions[i];
    if (own.freedom == 1.0 && own.columns.cols() == 1 && !candidates[i].frees_prior) {
      axes.strengths.col(count++) = turned(own.columns);
    }
  }
  axes.strengths.conservativeResize(Eigen::NoChange, count);
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

  /// What the means hold of strengths, and how they pull at them.
  struct Held {
    Eigen::MatrixXd information;  ///< no diagonal where the numbers take a strength up
    Eigen::VectorXd pull;
  };
  [[nodiscard]] Held held_of(const Eigen::MatrixXd& strengths) const {
    const Eigen::MatrixXd own = root_.asDiagonal() * strengths;
    Held held{own.transpose() * without_numbers(own), own.transpose() * rest_};
    constexpr double kAbsorbed = 1e-6;
    for (Eigen::Index i = 0; i < own.cols(); ++i) {
      if (!(held.information(i, i) > kAbsorbed * own.col(i).squaredNorm())) {
        held.information(i, i) = 0.0;
      }
    }
    return held;
  }

 private:
  [[nodiscard]] Eigen::MatrixXd without_numbers(const Eigen::MatrixXd& own) const {
    const Eigen::MatrixXd pull =
        information_.eigenvectors().transpose() * (numbers_.transpose() * own);
    return own -
           numbers_ * (information_.eigenvectors() * (known_.cwiseInverse().asDiagonal() * pull));
  }

  Eigen::VectorXd variance_;
  Eigen::VectorXd root_;
  Eigen::MatrixXd numbers_;
  SymmetricEigen information_;
  Eigen::VectorXd known_;
  Eigen::VectorXd rest_;
  double squares_;
};

/// Twice what the likeliest strength adds to ln of the likelihood: integrated over, as the numbers,
/// in units of what is known of it with the error as allowed for now.
double by_one(const Means::Held& now, const Means::Held& other) {
  double best = 0.0;
  for (Eigen::Index i = 0; i < now.pull.size(); ++i) {
    const double usual = now.information(i, i);
    const double held = other.information(i, i);
    if (usual > 0.0 && held > 0.0) {
      best = std::max(best, other.pull[i] * other.pull[i] / held - std::log(held / usual));
    }
  }
  return best;
}

/// The same of the likeliest two strengths.
double by_two(const Means::Held& now, const Means::Held& other) {
  constexpr double kAlike = 1e-4;
  const auto apart = [](const Eigen::MatrixXd& own, Eigen::Index i, Eigen::Index j) {
    const double both = own(i, i) * own(j, j);
    const double rest = both - own(i, j) * own(i, j);
    return rest > kAlike * both ? rest : 0.0;
  };
  double best = 0.0;
  for (Eigen::Index i = 0; i < now.pull.size(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double usual = apart(now.information, i, j);
      const double held = apart(other.information, i, j);
      if (usual > 0.0 && held > 0.0) {
        const Eigen::MatrixXd& own = other.information;
        const double a = other.pull[i];
        const double b = other.pull[j];
        const double gain =
            (own(j, j) * a * a - 2.0 * own(i, j) * a * b + own(i, i) * b * b) / held;
        best = std::max(best, gain - std::log(held / usual));
      }
    }
  }
  return best;
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
  const Means::Held usual = now.held_of(axes.strengths);
  constexpr double kStep = 1.05;
  constexpr double kLeast = 0.02;
  std::vector<double> likelihood;
  std::vector<double> with_two;
  for (double share = 1.0; share > kLeast; share /= kStep) {
    const Means other(axes, elsewhere, share * share - 1.0);
    const Means::Held held = other.held_of(axes.strengths);
    const double none = other.log_likelihood();
    likelihood.push_back(none + 0.5 * by_one(usual, held));
    with_two.push_back(none + 0.5 * by_two(usual, held));
  }
  // Two strengths may mimic what another code does smoothly: they count where they stand before
  // one as an effect has to before its rival.
  const double ahead = *std::max_element(with_two.begin(), with_two.end()) -
                       *std::max_element(likelihood.begin(), likelihood.end());
  if (ahead > 0.5 * kStandsBefore * kSolverDoubt) {
    likelihood = std::move(with_two);
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

#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/criticism/fitting/composition.hpp"
#include "processing/criticism/fitting/residuals.hpp"

namespace kolsky {

/// A composition at its best fit to a campaign.
struct ModelFit {
  std::vector<double> theta;    ///< in scales, as Composition::numbers
  Eigen::VectorXd residual;     ///< whitened
  Eigen::MatrixXd jacobian;     ///< d residual / d theta
  Eigen::MatrixXd information;  ///< J^T J + priors
  Eigen::MatrixXd covariance;   ///< of theta, its inverse
  Eigen::MatrixXd doubt;        ///< what a model that is calculated adds to that; empty: nothing
  double chi2 = 0.0;            ///< of the residuals
  double penalty = 0.0;         ///< of the priors
  double taken_by_noise = 0.0;  ///< see ShotResiduals
  bool converged = false;

  /// What fits are compared by.
  [[nodiscard]] double objective() const { return chi2 + penalty + taken_by_noise; }
  /// Degrees of freedom that the residuals have left.
  [[nodiscard]] double degrees_of_freedom(const Composition& composition) const;
};

/// Maximum a posteriori fit by Gauss and Newton's method with Levenberg's damping, inside bounds.
/// @param start  in scales; empty: the composition's
/// @param chord  derivatives from nearby, used as long as they serve; none: made at every step
[[nodiscard]] ModelFit fit_model(const Composition& composition, ShotResiduals& residuals,
                                 const Workers& executor, std::vector<double> start = {},
                                 const Eigen::MatrixXd* chord = nullptr);

/// The same where residuals are dear: steps teach the derivatives (Broyden's method), which are
/// made anew only where these stop coming true, and at the end.
/// @param chord   derivatives from nearby to begin with; none: made where the fit starts
/// @param settle  roughly: to 1 of the objective by what the steps have taught, which is then what
///                the covariance is made of
enum class Settle { fully, roughly };
[[nodiscard]] ModelFit fit_by_secants(const Composition& composition, ShotResiduals& residuals,
                                      const Workers& executor, std::vector<double> start = {},
                                      const Eigen::MatrixXd* chord = nullptr,
                                      Settle settle = Settle::fully);

/// Derivatives of the residuals by some of the free numbers, by differences.
[[nodiscard]] Eigen::MatrixXd derivatives(const Composition& composition, ShotResiduals& residuals,
                                          const std::vector<double>& theta,
                                          const Eigen::VectorXd& at_theta,
                                          const std::vector<std::size_t>& numbers,
                                          const Workers& executor);

/// The model with its values and deviations from a fit. Strengths per shot or per gauge give their
/// mean (per gauge: their root mean square).
[[nodiscard]] Model fitted(const Model& model, const Composition& composition, const ModelFit& fit);

}  // namespace kolsky

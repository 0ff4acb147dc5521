#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/criticism/fitting/fit.hpp"

namespace kolsky {

/// A fit on its way: where it is, its derivatives, and what steps from there do.
class FitSteps {
 public:
  /// @param start  in scales; empty: the composition's
  FitSteps(const Composition& composition, ShotResiduals& residuals, const Workers& executor,
           std::vector<double> start);

  /// A place that was tried.
  struct Step {
    std::vector<double> theta;
    Eigen::VectorXd residual;
    double chi2 = 0.0;
    double penalty = 0.0;
    double gain = 0.0;      ///< of the objective; not a number where the model refuses
    double foretold = 0.0;  ///< the same if the residuals were straight
    [[nodiscard]] bool better() const;
  };

  /// Derivatives by every free number where the fit is.
  void derive();
  void borrow(const Eigen::MatrixXd& jacobian);
  /// What a step tells of the derivatives along it (Broyden's update, numbers in units of what the
  /// data and priors hold of them). Before `take`.
  void learn(const Step& step);
  /// @param damping  Levenberg's, over the information's diagonal
  [[nodiscard]] Step tried(double damping);
  void take(Step step);
  /// The same derivatives where the fit is by now.
  void go_on() { linearise(); }
  /// What a full step would gain if the residuals were straight.
  [[nodiscard]] double promised() const { return promised_; }
  [[nodiscard]] double chi2_per_residual() const {
    return fit_.chi2 / static_cast<double>(fit_.residual.size());
  }
  /// Whether what is hardly told of stays where it is: far from the records steps along it go where
  /// all that is missed counts as noise, and of rough residuals only their roughness tells of it.
  [[nodiscard]] bool holds_weak() const;
  [[nodiscard]] bool nothing_free() const { return fit_.theta.empty(); }
  /// The fit as it stands, with its covariance.
  [[nodiscard]] ModelFit done(bool converged);
  /// The same where nothing is free: the model is what it is.
  [[nodiscard]] ModelFit as_it_is();

 private:
  void linearise();
  [[nodiscard]] Eigen::VectorXd move_inside(const Eigen::MatrixXd& information) const;
  [[nodiscard]] Step at(std::vector<double> theta);

  const Composition& composition_;
  ShotResiduals& residuals_;
  const Workers& executor_;
  Eigen::MatrixXd precision_;  ///< of the priors
  ModelFit fit_;
  Eigen::MatrixXd information_;  ///< without numbers that a bound holds
  Eigen::VectorXd downhill_;
  double promised_ = 0.0;
};

}  // namespace kolsky

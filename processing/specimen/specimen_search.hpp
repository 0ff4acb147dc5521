#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/specimen/specimen_likelihood.hpp"

namespace kolsky {

/// Where a search ended.
struct SpecimenMinimum {
  std::vector<double> parameters;  ///< logarithms of the solid's
  std::vector<double> moves;       ///< of the known unknowns, in their standard deviations
  double chi2 = 0.0;               ///< with the priors of the moves
  Eigen::MatrixXd covariance;      ///< of parameters and moves, for noise as it is taken to be
};

/// Minimises the whitened residuals with the priors of the known unknowns, by Levenberg's and
/// Marquardt's method. The weights are taken anew after every step and held while it is chosen:
/// that is the profile over the free sources to within the square of noise over signal.
class SpecimenSearch {
 public:
  SpecimenSearch(SpecimenLikelihood& likelihood, SolidKind solid, ShpbTheory theory);

  /// From the best place of a coarse grid over moduli and retardation times.
  [[nodiscard]] std::vector<double> start();

  /// @throws InputError where it does not converge
  [[nodiscard]] SpecimenMinimum minimise(const std::vector<double>& start);

 private:
  struct Point {
    std::vector<double> parameters;
    std::vector<double> moves;
  };
  [[nodiscard]] Point point(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd residuals(const Eigen::VectorXd& x, const Eigen::MatrixXd& root);
  [[nodiscard]] Eigen::MatrixXd root(const Eigen::VectorXd& x);
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::VectorXd& x, const Eigen::MatrixXd& root);

  SpecimenLikelihood& likelihood_;
  SolidKind solid_;
  ShpbTheory theory_;
  Eigen::Index solids_;
  Eigen::MatrixXd raw_;
};

}  // namespace kolsky

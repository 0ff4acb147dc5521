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

/// Between what the logarithms of a solid's parameters are looked for.
struct LogBounds {
  std::vector<double> lower;
  std::vector<double> upper;
};

/// Whether a solid may lose anything; one that does not is three elements with a branch that hardly
/// gives way.
enum class Loss { open, none };

/// Minimises the whitened residuals with the priors of the known unknowns, by Levenberg's and
/// Marquardt's method. The weights are taken anew after every step and held while it is chosen:
/// that is the profile over the free sources to within the square of noise over signal.
class SpecimenSearch {
 public:
  /// @pre three elements where there is no loss
  SpecimenSearch(SpecimenLikelihood& likelihood, SolidKind solid, ShpbTheory theory,
                 Loss loss = Loss::open);

  /// The best places of a coarse grid over moduli and retardation times, each of another modulus,
  /// the best first. More than one, for the weights are not known yet: by plain misfit alone the
  /// best may well lie where a search by weights finds nothing.
  [[nodiscard]] std::vector<std::vector<double>> starts();

  /// @throws InputError where it does not converge, or ends where the records say nothing of a
  ///   number of the solid
  [[nodiscard]] SpecimenMinimum minimise(const std::vector<double>& start);

  /// The whitening at a place: the lower Cholesky factor of one shot's covariance.
  [[nodiscard]] Eigen::MatrixXd weights_at(const SpecimenMinimum& place);

  /// By weights that are held, so that chi2 can be compared with another solid's by the same, and
  /// within bounds: numbers that the data leave open end there, not at infinity. Its covariance
  /// takes no number of the solid to be known worse than to a factor of e^5.
  /// @throws InputError where it does not converge
  [[nodiscard]] SpecimenMinimum minimise_held(const std::vector<double>& start,
                                              const std::vector<double>& moves,
                                              const Eigen::MatrixXd& weights,
                                              const LogBounds& bounds);

 private:
  struct Point {
    std::vector<double> parameters;
    std::vector<double> moves;
  };
  /// Where a search is.
  struct Place {
    Eigen::VectorXd x;
    Eigen::MatrixXd weights;
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
  };
  [[nodiscard]] Place place_at(const Eigen::VectorXd& x, Eigen::MatrixXd weights);
  /// @param bounds  null: none, and the weights are taken anew after every step
  [[nodiscard]] Place search(Place place, const LogBounds* bounds);
  [[nodiscard]] Eigen::VectorXd step_from(const Place& place, double damping,
                                          const LogBounds* bounds) const;
  [[nodiscard]] SpecimenMinimum minimum_at(const Place& place) const;
  void require_determined(const SpecimenMinimum& minimum) const;
  [[nodiscard]] double plain_misfit(const Eigen::VectorXd& x);
  [[nodiscard]] Eigen::VectorXd joined(const std::vector<double>& parameters,
                                       const std::vector<double>& moves) const;
  [[nodiscard]] Point point(const Eigen::VectorXd& x) const;
  [[nodiscard]] Eigen::VectorXd residuals(const Eigen::VectorXd& x, const Eigen::MatrixXd& root);
  [[nodiscard]] Eigen::MatrixXd root(const Eigen::VectorXd& x);
  [[nodiscard]] Eigen::MatrixXd jacobian(const Eigen::VectorXd& x, const Eigen::MatrixXd& root);

  SpecimenLikelihood& likelihood_;
  SolidKind solid_;
  ShpbTheory theory_;
  Loss loss_;
  Eigen::Index solids_;
  Eigen::MatrixXd raw_;
};

}  // namespace kolsky

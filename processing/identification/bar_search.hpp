#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <vector>

#include "processing/identification/bar_fit.hpp"
#include "processing/identification/bar_likelihood.hpp"

namespace kolsky {

inline constexpr double kTypicalTime_s = 50e-6;  ///< of a glassy polymer's retardation

/// What is known of a bar's parameters before its records are looked at.
struct ParameterPrior {
  Eigen::VectorXd centre;
  Eigen::VectorXd weight;  ///< 1 / variance

  [[nodiscard]] double chi2(const Eigen::VectorXd& at) const {
    return ((at - centre).array().square() * weight.array()).sum();
  }
};

/// A place in the parameters with what the data say there.
struct BarPlace {
  Eigen::VectorXd at;
  std::vector<ShotTerms> shots;
  double objective = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information;
};

/// The search for a bar's most likely numbers under one theory of it, in steps of rising price. A
/// step throws InputError where it does not converge.
class BarSearch {
 public:
  /// @param data outlives this
  BarSearch(const BarData& data, const BarTheory& theory);

  /// With all shots as one and the noise bin by bin, twice: weights turn with the phase of the
  /// waves, so that those of where it began do not do for where it ends.
  /// @param start  in BarModel's parameters; empty: from the pulses' speed and decay
  /// @param hopeless  the chi2 above which it need not go on, once its steps gain far less than
  /// lies
  ///   between
  void roughly(const std::vector<double>& start, double hopeless = HUGE_VAL);
  /// chi2 of all shots as one where that ended.
  [[nodiscard]] double rough_chi2() const { return place_.objective; }

  /// By the noise's weights as they are here, the lowest bins together; all shots still as one, as
  /// near as a comparison needs.
  void closely();
  /// From another place, by the weights of another search.
  void closely(const std::vector<double>& start, const BarLikelihood::Weights& weights);
  [[nodiscard]] const BarLikelihood::Weights& weights() const { return likelihood_.weights(); }

  /// What the search has come to, without the shots' own estimates.
  [[nodiscard]] BarFit so_far();
  /// The same after a search to the end, the last steps on every shot by itself.
  [[nodiscard]] BarFit finished();

  [[nodiscard]] std::vector<double> at() const;

 private:
  void go_to(const std::vector<double>& at);
  [[nodiscard]] double objective_at(const Eigen::VectorXd& at, BarLikelihood::Shots shots);
  [[nodiscard]] BarPlace looked_at(const Eigen::VectorXd& at, double objective);
  /// @return whether it came to an end below `hopeless`
  bool minimise(BarLikelihood::Shots shots, double negligible_gain, double hopeless = HUGE_VAL);
  void to_the_end();
  [[nodiscard]] bool rings_with_a_loss_that_shows();
  void take_off_what_noise_adds();
  [[nodiscard]] BarFit describe(double objective) const;
  [[nodiscard]] BarFit describe(double objective, const Eigen::MatrixXd& posterior) const;
  [[nodiscard]] double chi2_reduced(double objective) const;
  [[nodiscard]] BarFit described_with_shots();
  [[nodiscard]] std::vector<OctaveLeft> left_over();

  BarLikelihood likelihood_;
  ParameterPrior prior_;
  BarPlace place_;
};

/// A rough search; where it does not end, from the elastic bar.
/// @throws InputError where it does not end even then
[[nodiscard]] std::unique_ptr<BarSearch> rough_search(const BarData& data, const BarTheory& theory,
                                                      const std::vector<double>& start,
                                                      double hopeless = HUGE_VAL);

/// A place of three elements, in BarModel's parameters, with a solid of this modulus that loses
/// nothing.
[[nodiscard]] std::vector<double> elastic_start(std::vector<double> at, double E_Pa);

/// Where a bar shows no loss, its retardation can be anything and a search of three elements may
/// not end; it does from the elastic bar.
[[nodiscard]] bool may_be_elastic(const BarTheory& theory);
[[nodiscard]] std::unique_ptr<BarSearch> search_from_elastic(const BarData& data,
                                                             const BarTheory& theory);

}  // namespace kolsky

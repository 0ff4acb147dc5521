#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "processing/base/workers.hpp"
#include "processing/criticism/fitting/composition.hpp"

namespace kolsky {

/// Whitened residuals of a campaign under a composition of effects, whatever the experiment: what a
/// fit needs to know. Evaluations in different workers may run at once.
class ShotResiduals {
 public:
  ShotResiduals() = default;
  virtual ~ShotResiduals() = default;
  ShotResiduals(const ShotResiduals&) = delete;
  ShotResiduals& operator=(const ShotResiduals&) = delete;

  /// All shots' residuals, shot by shot, of unit variance under the true model.
  /// @param theta  one per free number of the composition, in scales
  [[nodiscard]] virtual Eigen::VectorXd evaluate(const Composition& composition,
                                                 const std::vector<double>& theta,
                                                 std::size_t worker) = 0;
  /// The same, its work shared out where that is worth it.
  [[nodiscard]] virtual Eigen::VectorXd evaluate_on(const Workers& executor,
                                                    const Composition& composition,
                                                    const std::vector<double>& theta) {
    return evaluate(composition, theta, executor.first);
  }
  /// Those of one shot. @pre not shots_hang_together()
  [[nodiscard]] virtual Eigen::VectorXd evaluate_shot(const Composition& composition,
                                                      const std::vector<double>& theta,
                                                      std::size_t shot, std::size_t worker) = 0;
  /// Whether differences between nearby numbers, as well as a rough fit's steps need them, are to
  /// be had for less than these residuals.
  [[nodiscard]] virtual bool has_quick_differences() const { return false; }
  /// What those are taken of; where they are not, the residuals themselves.
  [[nodiscard]] virtual Eigen::VectorXd evaluate_for_differences(const Composition& composition,
                                                                 const std::vector<double>& theta,
                                                                 std::size_t worker) {
    return evaluate(composition, theta, worker);
  }
  /// By how much the residuals' squares are less for noise that is foretold but not known: no fit
  /// may count it as a gain.
  [[nodiscard]] virtual double taken_by_noise(const Composition& /*composition*/,
                                              const std::vector<double>& /*theta*/,
                                              std::size_t /*worker*/) {
    return 0.0;
  }
  /// The shortest step of a difference, in scales, that shows what a number does and not how its
  /// residuals are calculated.
  [[nodiscard]] virtual double least_difference() const { return 0.0; }
  [[nodiscard]] virtual std::size_t per_shot() const = 0;
  /// Whether a shot's whitened residuals depend on other shots' records.
  [[nodiscard]] virtual bool shots_hang_together() const { return false; }
};

}  // namespace kolsky

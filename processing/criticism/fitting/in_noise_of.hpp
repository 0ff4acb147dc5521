#pragma once

#include "processing/criticism/fitting/residuals.hpp"
#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Residuals whitened as one fit has the noise, whatever composition they are of. What noise waves
/// carry from gauge to gauge depends on how they travel, and reckoning it is half the work of an
/// evaluation; of a misfit many times the noise nothing hangs on it.
class InNoiseOf final : public ShotResiduals {
 public:
  /// @param known  the fit; outlives this, as the residuals do
  InNoiseOf(WhiteResiduals& residuals, const Studied& known)
      : residuals_(residuals), known_(known) {}

  Eigen::VectorXd evaluate(const Composition& composition, const std::vector<double>& theta,
                           std::size_t worker) override {
    return residuals_.evaluate_in_noise_of(known_.composition, known_.fit.theta, composition, theta,
                                           worker);
  }
  Eigen::VectorXd evaluate_shot(const Composition& composition, const std::vector<double>& theta,
                                std::size_t shot, std::size_t worker) override {
    return residuals_.evaluate_shot_in_noise_of(known_.composition, known_.fit.theta, composition,
                                                theta, shot, worker);
  }
  double taken_by_noise(const Composition& /*composition*/, const std::vector<double>& /*theta*/,
                        std::size_t worker) override {
    return residuals_.taken_by_noise(known_.composition, known_.fit.theta, worker);
  }
  [[nodiscard]] std::size_t per_shot() const override { return residuals_.per_shot(); }

 private:
  WhiteResiduals& residuals_;
  const Studied& known_;
};

}  // namespace kolsky

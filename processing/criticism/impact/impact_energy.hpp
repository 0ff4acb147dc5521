#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/criticism/impact/impact_whitening.hpp"

namespace kolsky {

/// Energies of impacts' records over that of their noise, all by the noise alone: what the
/// calculation may be off by is no part of what the gauges said. Rebound speeds have no energy.
class ImpactEnergy {
 public:
  /// @param records  outlives this
  /// @param noise    covariance of one shot's judged samples
  /// @param inverse  of it
  ImpactEnergy(const ImpactRecords& records, const std::vector<ImpactShape>& shapes,
               const Eigen::MatrixXd& noise, const Eigen::MatrixXd& inverse, double speed_sd);

  /// Of all records.
  [[nodiscard]] double signal() const { return signal_; }
  /// What noise leaves of it once each shot's arrival and offsets are taken up.
  [[nodiscard]] double noise() const { return noise_; }
  /// What the residuals that all shots of a speed share hold, less what noise and the speeds'
  /// deviations would leave there.
  /// @param means  the groups', below each other
  [[nodiscard]] double repeated(const Eigen::VectorXd& means) const;

 private:
  const ImpactRecords& records_;
  std::vector<Eigen::MatrixXd> weight_;  ///< by group: the noise's inverse, clear of what is free
  std::vector<double> expected_;         ///< by group: of the shared residuals, times its shots
  double signal_ = 0.0;
  double noise_ = 0.0;
};

}  // namespace kolsky

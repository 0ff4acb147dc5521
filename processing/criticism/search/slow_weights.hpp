#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// Weights for noise that is slower than a record, or whose ends are cut off: whitened frequency by
/// frequency, the residuals hang together all the same, so that they look like a slow pulse more
/// often than as many independent numbers would. Never more weight than independent ones have.
class SlowWeights {
 public:
  /// @param parts     of a shot's whitened residuals that slow noise is made of (`parts_of_own`)
  /// @param residual  by shot. One that differs from the others may have taught the spectra more
  ///   noise than they have: the noise is as strong as it is in most of them at most
  SlowWeights(Eigen::MatrixXd parts, const Eigen::MatrixXd& residual);

  /// Rows of all shots below each other, so many per shot, weighed.
  void weigh(Eigen::Ref<Eigen::MatrixXd> rows, std::size_t per_shot) const;

  /// A fit with its residuals and derivatives weighed, moved to where it is best then.
  [[nodiscard]] Studied refitted(const Studied& studied, std::size_t per_shot) const;

 private:
  Eigen::MatrixXd modes_;  ///< orthonormal, in which noise is stronger than where it is white
  Eigen::VectorXd loss_;   ///< of amplitude in each, as a share
};

/// Of gauges' own slow noise and of such noise in common, as strong as the spectra have it. None
/// where noise is nearly white.
[[nodiscard]] std::vector<SlowWeights> slow_weights(Study& study, const Studied& studied);

}  // namespace kolsky

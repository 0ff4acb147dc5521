#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "processing/criticism/noise/gauge_noise.hpp"

namespace kolsky {

/// What makes residuals of all gauges but the reference of unit variance, bin by bin, for one way
/// that waves carry the reference gauge's noise to the others.
class Whitener {
 public:
  /// @param noise  outlives this
  Whitener(const GaugeNoise& noise, std::size_t gauges, std::size_t reference);

  /// @param carried  by judged bin, of these filters: by other gauge, how the residual has the
  /// reference's noise; where the reference is long, the mean over its length; then, where it is
  /// long or others share its noise, all of it
  void know(std::span<const CarriedBin> carried);

  /// The inverse Cholesky factor of half the residuals' covariance G P G^H, since real and
  /// imaginary parts are of unit variance each. Others x others.
  [[nodiscard]] const Eigen::MatrixXcd& factor(std::size_t bin) const { return factor_[bin]; }
  /// P G^H, gauges x others: what residuals say of each gauge's noise.
  [[nodiscard]] const Eigen::MatrixXcd& cross(std::size_t bin) const { return cross_[bin]; }
  /// Shares of what is foretold that window ends leak of slow noise, over all bins and gauges.
  [[nodiscard]] double leaked() const { return leaked_; }

 private:
  [[nodiscard]] double know_bin(const CarriedBin& carried, std::size_t bin);

  const GaugeNoise& noise_;
  std::size_t gauges_;
  std::size_t reference_;
  std::vector<std::size_t> others_;
  std::vector<Eigen::MatrixXcd> factor_;  ///< by bin
  std::vector<Eigen::MatrixXcd> cross_;   ///< by bin
  double leaked_ = 0.0;
};

}  // namespace kolsky

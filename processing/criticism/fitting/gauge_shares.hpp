#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "processing/criticism/noise/whitener.hpp"
#include "processing/waves/compliance.hpp"

namespace kolsky {

/// How one shot's whitened residuals are shared out among all gauges, the reference included: the
/// best estimate of each gauge's deviation from a wave common to all,
///     e = P G^H (G P G^H)^-1 r.
class GaugeShares {
 public:
  /// From then on as this whitens.
  void take(const Whitener& whitener, std::size_t bins);

  /// Whether `take` has been called.
  [[nodiscard]] bool known() const { return !spread_.empty(); }
  /// Whitened residuals at a bin, times this, are all gauges' deviations there: gauges x others.
  [[nodiscard]] const Eigen::MatrixXcd& spread(std::size_t bin) const { return spread_[bin]; }
  /// A gauge's deviation at a bin. @param white  of one shot
  [[nodiscard]] Complex at(std::size_t gauge, std::size_t bin, std::span<const double> white) const;

 private:
  std::vector<Eigen::MatrixXcd> spread_;  ///< by bin
};

}  // namespace kolsky

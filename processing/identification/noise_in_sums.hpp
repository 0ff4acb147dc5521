#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "processing/identification/bar_data.hpp"

namespace kolsky {

/// What the gauges' noise makes of sums over a shot's judged residuals,
///     sum over gauges and bins of Re(conj(weight) residual),
/// without any approximation that whitening needs: gauge 0's noise goes through the model from
/// where it enters to the end of what is judged, by way of the far end too, and the error of its
/// baseline with it; each gauge's own shows its spectrum through the ends of what is judged.
///
/// Holds work space: one thread at a time.
class NoiseInSums {
 public:
  /// @param data, noise  outlive this
  /// @param responses  at the lower rate, of each gauge but the first to what gauge 0 reads in the
  ///   record's first sample
  /// @param own  the same of a gauge to its own reading
  NoiseInSums(const BarData& data, const BarNoise& noise,
              const std::vector<std::vector<double>>& responses, std::span<const double> own);

  /// Covariance of several sums. @param weights  by gauge but the first: a column a sum, a row a
  /// bin
  [[nodiscard]] Eigen::MatrixXd covariance(const std::vector<Eigen::MatrixXcd>& weights);

 private:
  [[nodiscard]] BarData::Spectrum spectrum_of(std::span<const double> in_time);
  [[nodiscard]] BarData::Spectrum in_judged_part(const Eigen::VectorXcd& weights);
  [[nodiscard]] BarData::Spectrum within_record(const BarData::Spectrum& spectrum);
  [[nodiscard]] double power(std::size_t gauge, std::size_t bin) const;

  const BarData& data_;
  const BarNoise& noise_;
  DampedTransform judged_;  ///< of what is judged
  DampedTransform whole_;   ///< of twice the record, so that nothing comes round
  std::vector<BarData::Spectrum> responses_;
  BarData::Spectrum own_;
};

}  // namespace kolsky

#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <random>
#include <vector>

#include "processing/criticism/fitting/residuals.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// Whether waves still ring when the records end, so that what they carry of the reference gauge's
/// noise, of which a record holds none from before it began, grows all through it.
[[nodiscard]] bool rings_on(const PlainResiduals& plain, std::size_t judged);

/// Residuals of noise alone but for a coarse converter's rounding, drawn: each gauge's own as its
/// records hold it, less its mean before the pulse, and of the reference gauge's what waves carry
/// of it from the record's beginning on.
///
/// Parts of a spectrum are drawn as signs: of the same second moments as a normal variable, which
/// are all that is asked for.
class DrawnNoise {
 public:
  /// @param residuals  outlives this
  DrawnNoise(const WhiteResiduals& residuals, const PlainResiduals& plain);

  /// One shot's. @return by other gauge, over the judged window, filtered as its residuals are
  [[nodiscard]] std::vector<std::vector<double>> next();

 private:
  using Spectrum = std::vector<Complex>;

  [[nodiscard]] std::vector<Spectrum> spectra();
  [[nodiscard]] std::vector<double> record_of(const Spectrum& spectrum);
  void put_carried(const std::vector<double>& record, const Spectrum& response,
                   std::vector<double>& out);
  [[nodiscard]] Complex sign();

  const WhiteResiduals& residuals_;
  std::size_t before_;
  std::size_t quiet_;
  std::size_t samples_;  ///< of a record
  DampedTransform transform_;
  std::vector<Spectrum> responses_;
  std::vector<double> filter_;           ///< by bin, as far as it passes anything
  std::vector<Eigen::MatrixXd> factor_;  ///< of the gauges' covariance, by judged bin
  std::mt19937_64 random_;
};

}  // namespace kolsky

#pragma once

#include <Eigen/Core>
#include <vector>

#include "processing/criticism/fitting/residuals.hpp"
#include "processing/waves/transform.hpp"

namespace kolsky {

/// How one gauge's records deviate from the wave common to all.
struct GaugeDeviation {
  std::size_t gauge = 0;
  /// By shot, over the judged window: of unit power at every judged bin where there is noise alone
  /// (2 per bin of the window's transform), with a smooth end above them.
  std::vector<std::vector<double>> records;
  std::vector<double> scale;  ///< strain per unit, by judged bin
};

/// Each gauge's deviation from the wave common to all, the shots' sources at their best, over its
/// own standard deviation.
///
/// The source is estimated and sent to the gauges on a transform of twice the window's length: what
/// it sends beyond the record's end must not come round to its start. Above the judged band the
/// records' filter fades deviations out; cut off there they would ring before their pulses.
///
/// Of all gauges the one at fault stands out furthest (Baarda's test for outliers). Where one does
/// beyond doubt, and the others agree without it, they are taken without it, or a free source would
/// book a part of its fault to them; where they do not agree, the next is left out too, as long as
/// more are left than that.
class GaugeDeviations {
 public:
  /// @param residuals  as frozen at theta
  GaugeDeviations(WhiteResiduals& residuals, const Composition& composition,
                  const std::vector<double>& theta);

  /// Of shots `first` to `end`.
  [[nodiscard]] std::vector<GaugeDeviation> of_shots(std::size_t first, std::size_t end);

  /// As many judged bins would have the records' power.
  [[nodiscard]] std::size_t bins_held() const { return bins_held_; }

 private:
  using Spectrum = std::vector<Complex>;
  /// The source's estimate where some gauges are left out.
  struct Estimate {
    Eigen::MatrixXcd weight;  ///< by gauge and bin: of the gauges' deviations in it
    Eigen::MatrixXd sd;       ///< by gauge and bin: of each gauge's deviation
  };
  struct Found {
    std::vector<std::vector<Spectrum>> spectra;  ///< by shot and gauge, over their deviations
    std::vector<double> energy;                  ///< by gauge, over the judged bins and all shots
  };

  [[nodiscard]] Estimate estimate(const std::vector<bool>& left_out) const;
  [[nodiscard]] Found found(const Estimate& estimate, std::size_t first, std::size_t end) const;
  [[nodiscard]] static double excess_of_others(const Found& now, const std::vector<bool>& left_out,
                                               double freedom);
  [[nodiscard]] std::vector<bool> at_fault(const Found& all, std::size_t first,
                                           std::size_t end) const;
  [[nodiscard]] std::size_t judged_bin(std::size_t fine) const;

  const WhiteResiduals& residuals_;
  DampedTransform transform_;  ///< twice the judged window long
  std::size_t bins_ = 0;       ///< of it, as far as the filter passes anything
  std::size_t bins_held_ = 0;
  std::vector<double> gain_;              ///< by bin: what makes filtered records' power even
  Eigen::MatrixXcd waves_;                ///< by gauge and bin: per unit source
  std::vector<std::vector<Spectrum>> y_;  ///< by shot and gauge: records less what is foretold
};

}  // namespace kolsky

#pragma once

#include <Eigen/Core>
#include <map>
#include <vector>

#include "processing/criticism/comparing/tile_noise.hpp"
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
  /// The same of shots of noise alone, where that is not of unit power; null: it is.
  const std::vector<std::vector<double>>* drawn = nullptr;
  /// What coarse converters leave of each shot, by shot and draw (drawn_rounding.hpp), which that
  /// noise is without; null: none is coarse.
  const std::vector<std::vector<std::vector<double>>>* rounded = nullptr;
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
///
/// Deviations are of unit power as long as noise is stationary. Where waves ring to the record's
/// end it is not: what they carry of it begins with the record, and a gauge may be told by the
/// others early and tell them late. Then noise is drawn and goes the same way. So does what coarse
/// converters leave, which is where records creep.
class GaugeDeviations {
 public:
  /// @param residuals  as frozen at theta
  GaugeDeviations(WhiteResiduals& residuals, const Composition& composition,
                  const std::vector<double>& theta);

  /// Of all shots.
  [[nodiscard]] std::vector<GaugeDeviation> by_gauge();

  /// From now on deviations come with those of drawn noise, where waves ring to the record's end.
  /// Nothing new where they do already. @return whether they do
  bool draw_where_waves_ring();

  /// As many judged bins would have the records' power.
  [[nodiscard]] std::size_t bins_held() const { return bins_held_; }
  /// Whether deviations come with those of drawn noise.
  [[nodiscard]] bool draws() const { return !drawn_.empty(); }

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
  using Records = std::vector<std::vector<double>>;
  /// What drawn noise leaves of an estimate.
  struct Drawn {
    std::vector<TileNoise> energy;  ///< by gauge, of all shots
    // Where asked for.
    std::vector<Records> records;               ///< by gauge and draw
    std::vector<std::vector<Records>> rounded;  ///< by gauge, shot and draw
  };

  [[nodiscard]] Estimate estimate(const std::vector<bool>& left_out) const;
  [[nodiscard]] std::vector<Spectrum> received(const std::vector<std::vector<double>>& residuals);
  [[nodiscard]] std::vector<Spectrum> deviations(const Estimate& estimate,
                                                 const std::vector<Spectrum>& received) const;
  [[nodiscard]] double energy_of(const Spectrum& deviation) const;
  [[nodiscard]] Found found(const Estimate& estimate) const;
  [[nodiscard]] Drawn& drawn(const std::vector<bool>& left_out, const Estimate& estimate);
  void put_drawn_records(const Estimate& estimate, Drawn& out);
  void draw_noise();
  void draw_rounding(WhiteResiduals& residuals, const Composition& composition,
                     const std::vector<double>& theta);
  [[nodiscard]] std::vector<TileNoise> drawn_energy(const Estimate& estimate) const;
  void add_rounded_energy(const Estimate& estimate, std::vector<PlaceNoise>& energy) const;
  [[nodiscard]] std::vector<TileNoise> noise_energy(const std::vector<bool>& left_out,
                                                    const Estimate& estimate);
  [[nodiscard]] static double excess_of_others(const Found& now, const std::vector<bool>& left_out,
                                               const std::vector<TileNoise>& noise);
  [[nodiscard]] std::vector<bool> at_fault(const Found& all, const Estimate& estimate);
  [[nodiscard]] std::size_t judged_bin(std::size_t fine) const;

  const WhiteResiduals& residuals_;
  PlainResiduals plain_;
  DampedTransform transform_;  ///< twice the judged window long
  std::size_t bins_ = 0;       ///< of it, as far as the filter passes anything
  std::size_t bins_held_ = 0;
  std::vector<double> filter_;            ///< by bin
  std::vector<double> gain_;              ///< by bin: what makes filtered records' power even
  Spectrum mean_;                         ///< by bin: over a long reference gauge; empty: a point
  Eigen::MatrixXcd waves_;                ///< by gauge and bin: per unit source
  std::vector<std::vector<Spectrum>> y_;  ///< by shot and gauge: records less what is foretold
  std::vector<std::vector<Spectrum>> drawn_;  ///< by draw and gauge: the same of noise alone
  /// By shot, draw and gauge: the same of what coarse converters leave.
  std::vector<std::vector<std::vector<Spectrum>>> rounded_;
  std::map<std::vector<bool>, Drawn> drawn_of_;  ///< by gauges left out
};

}  // namespace kolsky

#pragma once

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "processing/criticism/noise/carried_noise.hpp"
#include "processing/criticism/records/campaign.hpp"
#include "processing/criticism/records/judged_band.hpp"

namespace kolsky {

class NoiseSpectrum;

/// How much of what residuals show counts as noise.
enum class NoiseShown {
  all,               ///< scatter from shot to shot too, whatever it comes from
  what_quiet_hides,  ///< as much as the quiet parts are too short to show
  pink_alone         ///< of that, what grows as 1/f; see `hold_to`
};

/// The noise of all gauges at the judged bins: its spectrum and how far gauges share it from the
/// quiet parts of all shots, times what residuals have shown of it since.
class GaugeNoise {
 public:
  GaugeNoise(const Campaign& campaign, const JudgedBand& band);
  ~GaugeNoise();
  GaugeNoise(const GaugeNoise&) = delete;
  GaugeNoise& operator=(const GaugeNoise&) = delete;

  /// Covariance of the gauges at a bin, in power of the judged window's transform.
  void put_covariance(std::size_t bin, Eigen::MatrixXd& all) const;
  /// The same without what `add_steps` added.
  void put_covariance_but_steps(std::size_t bin, Eigen::MatrixXd& all) const;
  /// That of two gauges.
  [[nodiscard]] double covariance(std::size_t bin, std::size_t a, std::size_t b) const {
    return covariance(scale_, bin, a, b);
  }
  /// Whether any other has a part of this gauge's noise.
  [[nodiscard]] bool shared_with(std::size_t gauge) const;
  [[nodiscard]] std::size_t gauges() const { return scale_.size(); }
  /// How far gauges share their noise.
  [[nodiscard]] const Eigen::MatrixXd& correlation() const { return correlation_; }
  /// Of a gauge's power at a bin what slow noise leaks for differing between the window's ends.
  [[nodiscard]] double leaked(std::size_t gauge, std::size_t bin) const {
    const Scales& scale = knows_steps() ? but_steps_ : scale_;
    return times_jumps_ * scale[gauge][bin] * leaked_[gauge][bin];
  }
  /// Whether any gauge's does.
  [[nodiscard]] bool jumps() const { return jumps_; }
  /// How many times as much of that residuals show as the quiet parts foretell: 1 before they do.
  [[nodiscard]] double times_jumps() const { return times_jumps_; }
  void keep_times_jumps(double times) { times_jumps_ = times; }
  /// That of one gauge.
  [[nodiscard]] double power(std::size_t gauge, std::size_t bin) const;
  /// That over what the quiet parts say.
  [[nodiscard]] double scale(std::size_t gauge, std::size_t bin) const {
    return scale_[gauge][bin];
  }
  /// Of a gauge before residuals said anything, strain^2 per judged sample.
  [[nodiscard]] double quiet_power(std::size_t gauge) const;

  /// What the other gauges' residuals hold of the reference gauge's noise, as the quiet parts have
  /// it. Parameters as CarriedNoise::through.
  void carry(std::span<const std::vector<double>> responses, CarriedNoise::Memory& memory,
             std::vector<CarriedBin>& bins) const;

  /// Takes the quiet parts at their word again.
  void forget();
  /// Whether steps of this gauge's converter exceed its noise.
  [[nodiscard]] bool is_coarse(std::size_t gauge) const;
  /// Adds what a coarse converter's steps leave of records that move, where the quiet parts do not
  /// tell. @param clean  a gauge's records by shot, over the judged window at their own rate
  void add_steps(std::size_t gauge, std::span<const std::vector<double>> clean);
  /// Whether that was done to any gauge.
  [[nodiscard]] bool knows_steps() const { return !but_steps_.empty(); }
  /// Deviation of this gauge's noise before its converter rounded it; see converter_steps.hpp.
  [[nodiscard]] double unrounded_sd(std::size_t gauge) const;
  /// @param power_over_quiet  of a gauge at each bin, as residuals show it; made smooth
  void learn(std::size_t gauge, const std::vector<double>& power_over_quiet, NoiseShown shown);

  /// What the quiet parts show of each gauge's noise at the frequencies that they resolve within
  /// the judged band, over what is known of it.
  struct QuietPower {
    std::vector<double> at_bin;                 ///< of the judged window's transform
    std::vector<std::vector<double>> by_gauge;  ///< mean over the shots, by frequency
    double shots = 0.0;
  };
  [[nodiscard]] QuietPower quiet_power_over_known() const;
  /// Takes back of what was learned what not all gauges have and what the quiet parts contradict,
  /// each gauge's its own and all together. Of a coarse converter nothing is learned.
  void hold_to(const QuietPower& quiet);

  using Scales = std::vector<std::vector<double>>;  ///< by gauge and bin
  [[nodiscard]] const Scales& scales() const { return scale_; }
  /// Learns a share of what was learned once.
  void scale_by(const Scales& learned, double share);

  /// How near the least white gauge's noise is to white: the geometric over the arithmetic mean of
  /// its power over the judged bins. Where it is 1, all frequencies tell of the noise at each.
  [[nodiscard]] double flatness() const;

 private:
  [[nodiscard]] double covariance(const Scales& scale, std::size_t bin, std::size_t a,
                                  std::size_t b) const {
    return std::sqrt(scale[a][bin] * scale[b][bin]) *
           quiet_[bin](static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  }
  void put(const Scales& scale, std::size_t bin, Eigen::MatrixXd& all) const;
  [[nodiscard]] double most_hidden(std::size_t bin) const;
  [[nodiscard]] double against(const QuietPower& quiet, std::size_t gauge, double share) const;
  /// The judged bin next to a place between bins.
  [[nodiscard]] std::size_t judged_bin(double at) const;
  void keep_alike();
  void keep_share(std::size_t gauge, double share);
  void measure(const std::vector<NoiseSpectrum>& spectra, const Eigen::MatrixXd& correlation);

  const Campaign& campaign_;
  JudgedBand band_;
  std::vector<Eigen::MatrixXd> quiet_;  ///< by bin
  Eigen::MatrixXd correlation_;
  std::vector<std::vector<double>> leaked_;  ///< by gauge and bin, of quiet_
  bool jumps_ = false;
  double times_jumps_ = 1.0;
  std::vector<std::vector<double>> scale_;  ///< by gauge and bin
  Scales but_steps_;                        ///< the same before steps were added; empty: none were
  std::unique_ptr<CarriedNoise> carried_;
};

}  // namespace kolsky

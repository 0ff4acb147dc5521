#pragma once

#include <functional>
#include <vector>

#include "processing/identification/bar_data.hpp"

namespace kolsky {

/// Records of all shots from shortly before the pulse on, damped, at the frequencies of a band.
struct DampedBand {
  double eta_per_s = 0.0;
  double period_s = 0.0;
  double seconds = 0.0;
  std::vector<Complex> path;
  std::vector<double> frequency_Hz;
  std::vector<std::vector<std::vector<Complex>>> spectra;  ///< by shot, gauge, frequency

  /// Noise power of a sum over damped samples, by that over as many undamped ones.
  [[nodiscard]] double samples_seen() const {
    return -std::expm1(-2.0 * eta_per_s * seconds) / (2.0 * eta_per_s * period_s);
  }
};

/// Where the used part of a gauge's record begins.
[[nodiscard]] std::size_t begin_of(const BarRecords& records);

/// The damped records at the frequencies of the data's band.
/// @param samples  longest used part, from `begin_of`
/// @param left_at_end  what damping leaves of a wave at its end
/// @param bin_width_over  zeros are added to so many times the length
/// @param end  of what is used of a gauge's record, from `begin_of`, by shot and gauge
[[nodiscard]] DampedBand damped_band(
    const BarData& data, std::size_t samples, double left_at_end, double bin_width_over,
    const std::function<std::size_t(std::size_t, std::size_t)>& end);

/// The same frequencies without damping.
[[nodiscard]] std::vector<Complex> on_axis(const std::vector<Complex>& path);

/// Power by gauge of noise in damped sums, the error of the baseline with it, over all shots.
[[nodiscard]] std::vector<double> powers_at(const BarData& data, const DampedBand& band,
                                            std::size_t k);

}  // namespace kolsky

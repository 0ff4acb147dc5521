#pragma once

#include <cstddef>
#include <optional>
#include <span>

namespace kolsky {

/// Where a rising edge meets a level.
struct Crossing {
  double position = 0.0;     ///< in samples from the start of the span
  double slope = 0.0;        ///< codes per sample there
  double noise_share = 1.0;  ///< variance of the fitted value over the variance of one white sample
  double unresolved_variance =
      0.0;                 ///< of the position, samples²: the edge falls between two samples
  std::size_t points = 0;  ///< the fit rests on
};

/// Fits a cubic to the samples about the crossing, over as many of them as the edge takes to climb
/// about one level, so that noise is averaged and the edge is still smooth; at least four.
/// @param deviation  samples minus baseline, the edge rising
/// @param guess      index of a sample near the crossing
/// @param reach      samples that the fit may reach to either side: how long the edge takes for
/// half a level
/// @return none when no window of the span holds an upward crossing
[[nodiscard]] std::optional<Crossing> fit_crossing(std::span<const double> deviation,
                                                   std::size_t guess, double level,
                                                   std::size_t reach);

/// Variance of the mean of `block` successive samples, times `block`: for white noise the variance
/// of one sample whatever the block, for coloured noise what a fit over that many samples sees of
/// it. Blocks longer than an eighth of the span are shortened to that.
/// @param quiet  left without its line, and cut at the limit
/// @param limit  deviations from the line beyond it are spikes and count as the limit
/// @pre at least 32 samples
[[nodiscard]] double block_noise_variance(std::span<double> quiet, std::size_t block, double limit);

}  // namespace kolsky

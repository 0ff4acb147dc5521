#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace kolsky {

/// What noise of unit power per judged component leaves in a tile: its energy's mean, and how many
/// degrees of freedom a chi-square variable of the same mean and variance has.
struct TileNoise {
  double mean = 0.0;
  double freedom = 0.0;
};

/// Bins of a transform of the judged window, first to last.
struct BinRange {
  std::size_t first = 0;
  std::size_t end = 0;
};

/// Energies of z(t), a record that holds the judged bins 1..judged alone, real and imaginary parts
/// independent and of unit variance, after multiplication with a window: sum of |Z(f)|^2 over each
/// range of bins, Z by the transform in which z has them (bin 0 and the last count half).
///
/// The mean is exact. The variance takes the window's spectrum as narrow against the judged band:
/// Cov Z(f), Z(f') = 2/N times the transform of the squared window at f - f', and at f + f' without
/// the conjugate.
///
/// Bin 0 is not judged, so z floats; it is taken to be zero on average before the pulse: z(t) less
/// its mean there, weighted by `quiet`. That mean's own noise is counted as a component of its own.
/// @param window  one weight per sample, an even number of them
/// @param quiet   weights of the mean, summing to one; empty: nothing is subtracted
[[nodiscard]] std::vector<TileNoise> tile_noise(std::span<const double> window,
                                                std::span<const double> quiet, std::size_t judged,
                                                std::span<const BinRange> ranges);

}  // namespace kolsky

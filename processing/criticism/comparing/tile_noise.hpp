#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "processing/waves/transform.hpp"

namespace kolsky {

/// What noise of unit power per judged component leaves in a tile: a sum of squares of normal
/// variables, known by the traces of their covariance's first three powers. Those of independent
/// tiles add.
struct TileNoise {
  double mean = 0.0;
  double second = 0.0;  ///< half the variance
  double third = 0.0;   ///< an eighth of the third central moment

  /// Of a chi-square variable of the same mean and variance.
  [[nodiscard]] double freedom() const { return second > 0.0 ? mean * mean / second : 0.0; }
  /// ln probability of more than this: a chi-square variable, scaled and shifted to the same first
  /// three moments (Buckley and Eagleson 1988).
  [[nodiscard]] double log_tail(double energy) const;

  TileNoise& operator+=(const TileNoise& other);
};

/// As drawn noise shows it, of any variables of unit variance: products of different draws have the
/// traces as their means. @param draws  components by draw
[[nodiscard]] TileNoise tile_noise_of(const Eigen::MatrixXd& draws);

/// What noise leaves in a place, that of a coarse converter beside all other.
struct PlaceNoise {
  TileNoise normal;
  /// Energy of what rounding leaves, by where the converter's steps may lie; empty: its steps are
  /// lost in the noise. It is no sum of squares of normal variables: a record that creeps over a
  /// tenth of a step is mostly off by nothing, and by a whole step where it creeps over an edge.
  std::vector<double> rounded;

  /// Both together, by the first three moments of their sum.
  [[nodiscard]] TileNoise whole() const;
  /// Of another place, whose converters' steps lie where this one's do.
  PlaceNoise& operator+=(const PlaceNoise& other);
};

/// Bins of a transform of the judged window, first to last.
struct BinRange {
  std::size_t first = 0;
  std::size_t end = 0;
};

/// A weighted mean of noise before the pulse.
struct QuietMean {
  std::vector<double> weights;  ///< but for what no judged bin holds; empty: no mean is taken
  double power = 0.0;           ///< of their judged bins

  QuietMean() = default;
  /// @param transform  of the weights' length, without damping
  QuietMean(DampedTransform& transform, std::span<const double> weights, std::size_t judged);
};

/// Energies of z(t), a record that holds the judged bins 1..judged alone, real and imaginary parts
/// independent and of unit variance, after multiplication with a window: sum of |Z(f)|^2 over each
/// range of bins, Z by the transform in which z has them (bin 0 and the last count half).
///
/// Exact where a tile has few components; of many the variance is that of the window's squared
/// spectrum alone, as if it were narrow against the judged band.
///
/// Bin 0 is not judged, so z floats; it is taken to be zero on average before the pulse: z(t) less
/// its mean there. That mean's own noise is counted.
/// @param transform  of the window's length, without damping
/// @param window  one weight per sample, an even number of them
[[nodiscard]] std::vector<TileNoise> tile_noise(DampedTransform& transform,
                                                std::span<const double> window,
                                                const QuietMean& quiet, std::size_t judged,
                                                std::span<const BinRange> ranges);

}  // namespace kolsky

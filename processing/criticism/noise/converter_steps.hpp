#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "processing/waves/transform.hpp"

namespace kolsky {

/// What a converter's steps do to a record that moves by few of them while a wave passes: not white
/// noise of a twelfth of their square, but saw teeth as slow as the record. Rounding x + n to whole
/// steps q, n Gaussian of deviation s, leaves on average (Sripad and Snyder 1977)
///
///     sum_h q/(pi h) exp(-2 (pi h s/q)^2) (-1)^h sin(2 pi h x/q),   h = 1, 2, ...
///
/// @param transform  of the record's length, without damping
/// @param clean      the record as it was before
/// @return |transform|^2 of that at bins 1 to `bins`, the mean over where the steps may lie
[[nodiscard]] std::vector<double> rounding_power(DampedTransform& transform,
                                                 std::span<const double> clean, double step,
                                                 double noise_sd, std::size_t bins);

/// What rounding leaves of a record at one place.
class RoundingAt {
 public:
  RoundingAt(double step, double noise_sd);

  /// On average, by the same sum. @param strain  before it was rounded, from the middle of a step
  [[nodiscard]] double mean(double strain) const { return in(mean_, strain); }
  /// What noise makes of it from sample to sample, where it is more than on the whole: a record at
  /// rest between two codes goes over and back.
  [[nodiscard]] double variance_beyond(double strain) const { return in(beyond_, strain); }

 private:
  [[nodiscard]] double in(const std::vector<double>& table, double strain) const;

  double step_;
  std::vector<double> mean_;    ///< over a step, from its lower end to its upper one
  std::vector<double> beyond_;  ///< likewise
};

/// Deviation of white noise before rounding. A record at rest may show none of it between two
/// steps, so it is taken from where records cross a few steps slowly: they change over and
/// back there the more often, the more noise there is.
/// @return 0 where hardly anything moves so slowly: then nothing is known that smooths the steps
[[nodiscard]] double unrounded_sd(std::span<const std::span<const double>> records, double step);

}  // namespace kolsky

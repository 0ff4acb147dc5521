#pragma once

#include <cstddef>
#include <span>

namespace kolsky {

/// Samples from `begin` to before `end`.
struct SampleRange {
  std::size_t begin;
  std::size_t end;
};

/// A force before the impact, of which nothing but noise is known.
struct QuietForce {
  std::span<const double> force_N;
  std::size_t baseline_samples = 1;  ///< that a baseline is the mean of
  double period_s = 0.0;
};

/// One sigma, of noise and baseline.
struct ForceDeviations {
  double peak_sd = 0.0;     ///< N
  double impulse_sd = 0.0;  ///< N s
  double contact_sd = 0.0;  ///< s
};

/// What stretches of the quiet do when they are added to the force, each with a baseline of its
/// own.
/// @param threshold  share of the peak that bounds the contact
/// @param contact    what the impulse is summed over; it and a baseline fit into the quiet
[[nodiscard]] ForceDeviations drawn_deviations(std::span<const double> force_N,
                                               const QuietForce& quiet, double threshold,
                                               const SampleRange& contact);

}  // namespace kolsky

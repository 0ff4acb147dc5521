#pragma once

#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// Equilibrium over time: |front - back| over the mean of both forces, each averaged over a moving
/// window. NaN where the mean force is below a twentieth of its peak, and where equilibrium was
/// taken for granted, which leaves nothing to compare.
[[nodiscard]] std::vector<double> disagreement(const Reduction& reduction);

/// The part of the curve that may be quoted: both faces agree within the limit that `equilibrium`
/// has for the whole loading, or may be assumed to, and the strain still grows. None where the
/// strain is not to be had: the striker's push hidden by the reflection, or an open energy balance.
struct Quotable {
  bool any = false;
  bool assumed = false;  ///< that the faces carry the same force
  double from_s = 0.0;
  double to_s = 0.0;
  double from_strain = 0.0;
  double to_strain = 0.0;
  std::string text;  ///< for people
};

[[nodiscard]] Quotable quotable_part(const Reduction& reduction);

/// Signal over noise by frequency, of each bar's first station over the whole record.
struct SpectralQuality {
  std::vector<double> frequency_Hz;
  std::vector<double> input_dB;  ///< power over that of the noise before the pulse, per band
  std::vector<double> output_dB;
  /// The highest frequency up to which both are above 10 dB; 0 where there is none. Beyond it
  /// the histories hold shapes that noise has a say in.
  double useful_band_Hz = 0.0;
};

/// Empty where the shot cannot be reduced.
[[nodiscard]] SpectralQuality spectral_quality(const Shot& shot, const Reduction& reduction);

}  // namespace kolsky

#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/identification/bar_fit.hpp"
#include "processing/reduction/reduction.hpp"
#include "processing/specimen/specimen_fit.hpp"

namespace kolsky {

/// The specimen's compliance as strain over stress of the reduced histories (paper, eq. 25).
struct SpectralEstimate {
  /// Mean and scatter over the shots; bench exact. One shot has no scatter: NaN.
  std::vector<CompliancePoint> spectrum;
  std::vector<FittedNumber> parameters;  ///< a three-element solid through it
  double band_limit_Hz = 0.0;
  double window_s = 0.0;  ///< of the histories that every shot has
  /// How the waves of all shots were told apart: by equilibrium, which (25) takes for granted
  /// anyway, where time does not part them in some shot and the input bar has one gauge only.
  Separation separation = Separation::never;
  std::vector<std::string> warnings;  ///< what keeps it from being taken at its word
};

struct SpectralOptions {
  WaveTheory bars = WaveTheory::elementary;
  double band_limit_Hz = 15e3;  ///< of the fit and of what is listed
  /// Held; else as each shot needs it, and by equilibrium where time does not part the waves of
  /// one.
  std::optional<Separation> separation{};
};

/// Strain and stress are transformed along s = eta + i w: on the axis itself a history that is cut
/// before it has decayed leaks into every frequency (erratum 9). The solid is fitted there, weighed
/// by the stress's spectrum; what is listed is moved to the axis by what the fit changes on the
/// way. Deviations are the scatter over the shots: of the parameters by leaving one shot out in
/// turn, from three shots on; with fewer, from how far the points lie off the fit. Neither the
/// bench's nor the bars' deviations are in them, nor that the stress at both ends of the specimen
/// differs: the direct fit has those.
/// @throws InputError where a shot cannot be reduced or the histories are too short
[[nodiscard]] SpectralEstimate estimate_spectrum(const std::vector<Shot>& shots,
                                                 const Material& bars,
                                                 const SpectralOptions& options);

}  // namespace kolsky

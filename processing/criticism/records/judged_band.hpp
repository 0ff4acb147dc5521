#pragma once

#include <cstddef>

#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// The part of the records that is judged and how.
struct JudgedBand {
  double limit_Hz = 0.0;       ///< highest frequency judged
  double filter_Hz = 0.0;      ///< the filter passes half here
  std::size_t decimation = 1;  ///< residuals are formed at 1/decimation of the rate
  std::size_t lead = 0;        ///< zeros before a record [samples]
  std::size_t begin = 0;       ///< samples of a record before its judged window
  std::size_t judged = 0;      ///< samples of the judged window, decimated
  std::size_t bins_judged = 0;
  std::size_t bins_carried = 0;
  std::size_t transformed = 0;  ///< samples of the transform of a whole record
  double bin_width_Hz = 0.0;    ///< of the judged window's transform

  /// Of the bins judged, from 0; what is constant is not judged.
  [[nodiscard]] double frequency_Hz(std::size_t bin) const {
    return static_cast<double>(bin + 1) * bin_width_Hz;
  }
};

/// How much a transform of a record is damped at its end: what comes round is raised by its
/// inverse.
constexpr double kWrapDamping = 1e-8;

/// @param asked_Hz  0: where the pulses fall below the noise, at most where surface gauges go blind
/// @throws InputError where the records do not reach up to what is asked, or nothing is left to
/// judge
[[nodiscard]] JudgedBand judged_band(const Campaign& campaign, double asked_Hz);

}  // namespace kolsky

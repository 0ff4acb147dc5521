#pragma once

#include "processing/calibration/calibration.hpp"

namespace kolsky {

/// Above this reduced chi2 more than noise is left.
inline constexpr double kMoreThanNoise = 1.3;

/// Holds the bench against the shots of one arrangement (see calibrate).
[[nodiscard]] PartResult fit_part(const CalibrationPart& part, const CalibrationOptions& options);

}  // namespace kolsky

#pragma once

#include "processing/calibration/calibration.hpp"

namespace kolsky {

/// Holds the bench against the shots of one arrangement (see calibrate).
[[nodiscard]] PartResult fit_part(const CalibrationPart& part, const CalibrationOptions& options);

}  // namespace kolsky

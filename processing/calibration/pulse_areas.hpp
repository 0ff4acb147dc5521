#pragma once

#include <optional>
#include <string>
#include <vector>

#include "processing/base/measured.hpp"
#include "processing/calibration/arrangement.hpp"
#include "processing/criticism/records/campaign.hpp"

namespace kolsky {

/// Area of the first pulse at a gauge over that at the first gauge: 1 where both gains are right,
/// whatever the waves did between them (the impulse that passes a section passes them all).
struct AreaRatio {
  std::string gauge;
  Measured ratio;  ///< mean over shots, with the deviation that noise leaves of it
};

/// What a striker of known mass and speed says of the first gauge's gain.
struct MomentumCheck {
  std::string gauge;
  Measured gain;  ///< reading over true strain
  std::size_t shots = 0;
};

struct PulseAreas {
  std::string first_gauge;  ///< the ratios are to its area
  std::vector<AreaRatio> ratios;
  double window_s = 0.0;  ///< after the foot at each gauge; ends before anything comes back
  std::optional<MomentumCheck> momentum;
  double momentum_left = 0.0;       ///< deviations from the gain as calibrated
  std::string none_because;         ///< why there are no ratios
  std::string no_momentum_because;  ///< why there is no absolute gain
};

/// Gains without a model of the waves. The striker is taken to be of the bar's material where its
/// density is: with Z its impedance over the bar's it leaves 2 m v / (1 + Z) in the bar where it
/// rebounds (Z below 1), all of m v else. A bar's strain area stands for its stress by the modulus
/// at rest.
/// @param part  with two passes there is nothing to compare, and the momentum alone tells the gain
[[nodiscard]] PulseAreas pulse_areas(const CalibrationPart& part, const Campaign& campaign,
                                     const BarPrior& bars);

}  // namespace kolsky

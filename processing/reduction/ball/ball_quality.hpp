#pragma once

#include <string>

#include "processing/reduction/quality.hpp"
#include "processing/reduction/reduction.hpp"

namespace kolsky {

/// What the checks need besides the result.
struct BallQualityInputs {
  double peak_over_noise = 0.0;  ///< strain's, at the quietest place; infinite without noise
  double contact_end_s = 0.0;    ///< from first touch
  double after_contact_N =
      0.0;  ///< mean force from 50 us after the contact to the clean window's end
  double after_contact_sd_N = 0.0;
  double band_loss = 0.0;  ///< share of the wave's energy that the low-pass took
  std::string speed_problem{};
  FlatTop flat_top{};
};

/// Fills the quality of an impact. Limits and their reasons: docs/quality.md.
void judge(const BallQualityInputs& inputs, Reduction& reduction);

}  // namespace kolsky

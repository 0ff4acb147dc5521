#pragma once

#include <vector>

#include "processing/criticism/study.hpp"

namespace kolsky {

/// Each shot's sum of squared whitened residuals with the shared parameters fitted to the other
/// shots, to first order around the common fit. Strengths of a shot's own are found in the shot
/// itself, and their share of its noise is put back. With one shot: its own.
[[nodiscard]] std::vector<double> held_out_squares(const Studied& studied,
                                                   std::size_t residuals_per_shot);

/// What an effect brought on shots that the fits did not see.
struct Certification {
  double gain = 0.0;       ///< of chi2
  std::size_t better = 0;  ///< how many shots gained
};

[[nodiscard]] Certification certification(const Studied& before, const Studied& after,
                                          std::size_t residuals_per_shot);

}  // namespace kolsky

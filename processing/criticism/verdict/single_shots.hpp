#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

#include "processing/base/measured.hpp"
#include "processing/criticism/fitting/study.hpp"

namespace kolsky {

/// What a gauge would have to read differently in one shot.
struct ReadingOfShot {
  std::size_t gauge = 0;
  std::size_t shot = 0;
  Measured gain;      ///< of the reading, beside what the other shots have
  Measured delay_us;  ///< likewise
};

/// What shots do not have in common.
struct ShotsApart {
  double log_p = 0.0;  ///< ln of the chance that noise sets them so far apart
  std::optional<ReadingOfShot> furthest;
};

/// Columns of a gauge's gain and of its delay in the whitened residuals, over all shots.
struct SensorColumns {
  std::size_t gauge = 0;
  Eigen::MatrixXd columns;  ///< per unit of gain, and per microsecond of delay
};

/// ln of the chance that noise makes the shots ask for numbers of the model so far apart. A model
/// that lacks what grows with a shot's amplitude fits each by moduli of its own, and leaves little
/// of it.
/// @param known  degrees of freedom to which noise is known
[[nodiscard]] double log_p_of_own_numbers(const Studied& studied, std::size_t shots,
                                          std::size_t per_shot, double known);

/// Whether gauges read all shots alike: a gain and a delay of its own in every shot, gauge by gauge
/// and all together. Not every fault repeats, and one that comes and goes passes for noise where
/// noise is whatever does not repeat; but noise has no reason to look like the pulse.
[[nodiscard]] ShotsApart readings_apart(const Studied& studied,
                                        std::span<const SensorColumns> sensors, std::size_t shots,
                                        std::size_t per_shot, double known);

}  // namespace kolsky

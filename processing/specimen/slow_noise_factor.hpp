#pragma once

#include <Eigen/Core>

#include "processing/identification/noise_spectrum.hpp"

namespace kolsky {

/// What first-order noise does where single samples of it do this: its means over groups of
/// neighbouring samples hang together, and are made of independent causes, a column each, so that
/// the result times its transpose is the covariance.
/// @param response  numbers x groups in time, of unit noise all over a group
/// @param samples   of a group
[[nodiscard]] Eigen::MatrixXd by_slow_noise(Eigen::MatrixXd response,
                                            const NoiseSpectrum::SlowPart& part, double samples);

}  // namespace kolsky

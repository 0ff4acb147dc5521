#pragma once

#include <vector>

#include "processing/criticism/fitting/fit.hpp"

namespace kolsky {

/// In so many parts is a single shot's record held out, each a comb of short stretches: every part
/// sees the pulses of every window, none sees the instants of another.
constexpr std::size_t kRecordParts = 8;

/// A single shot's sums of squared whitened residuals, part by part, with all free numbers fitted
/// to the other parts, to first order around the common fit.
/// @param channels  whitened spectra side by side in the residuals: real and imaginary parts of all
/// channels at one bin, bin after bin
[[nodiscard]] std::vector<double> held_out_parts(const ModelFit& fit, std::size_t channels);

}  // namespace kolsky

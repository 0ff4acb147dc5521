#pragma once

#include <random>
#include <string>
#include <vector>

namespace kolsky::testing {

enum class NoiseColour {
  white,
  coloured,  ///< white with a slow part of the same size (first order, 30 us to 300 us)
  pink,      ///< equal power per octave
  measured,  ///< cut from the pre-trigger of somebody's records
};

[[nodiscard]] std::string name_of(NoiseColour colour);
/// @throws InputError
[[nodiscard]] NoiseColour colour_named(const std::string& name);

/// One record of noise of that rms.
[[nodiscard]] std::vector<double> noise(NoiseColour colour, double rms, double period_s,
                                        std::size_t samples, std::mt19937_64& random,
                                        const std::vector<double>& measured = {});

/// Covariance of two samples of noise of that rms, by how many samples lie between; of coloured
/// noise its mean over the times that are drawn. @param colour  not measured
[[nodiscard]] std::vector<double> covariance_of(NoiseColour colour, double rms, double period_s,
                                                std::size_t samples);

}  // namespace kolsky::testing

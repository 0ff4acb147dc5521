#pragma once

#include "processing/base/shot.hpp"
#include "tests/generators/noise.hpp"

namespace kolsky::testing {

/// What turns readings into a shot's codes.
struct Digitiser {
  double noise_strain = 4e-6;
  NoiseColour colour = NoiseColour::white;
  std::vector<double> measured_noise;  ///< for NoiseColour::measured
  int bits = 14;                       ///< 0: 32-bit codes, as an import of decimal tables has them
  double full_scale_strain = 5e-3;
  std::size_t pretrigger = 0;
  std::uint64_t seed = 0;
};

/// Readings (strain, per gauge) with offset, noise and quantisation, in the units that the bench
/// files.
[[nodiscard]] Shot digitised(const Bench& bench, const std::vector<std::vector<double>>& readings,
                             const std::vector<double>& offset_strain, const Digitiser& digitiser,
                             const std::map<std::string, std::string>& meta);

}  // namespace kolsky::testing

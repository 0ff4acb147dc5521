#pragma once

#include <random>
#include <vector>

#include "drivers/simulated/rod.hpp"
#include "processing/base/shot.hpp"
#include "tests/generators/noise.hpp"

namespace kolsky::testing {

/// Shots on a viscoelastic bar, solved once in the time domain on a staggered grid with internal
/// variables; elementary waves. Shots scale that solution, move gauges by its own derivative along
/// the bar, and add noise.
class BarShots {
 public:
  struct Setup {
    RodMaterial material{};
    double length_m = 2.0;
    double diameter_m = 0.020;
    double poisson_ratio = 0.36;
    std::vector<double> position_m = {0.1, 0.3, 0.5, 0.7};
    double pulse_s = 91e-6;
    double ramp_s = 25e-6;
    std::size_t pre_samples = 400;
    std::size_t post_samples = 3600;
  };
  /// How a shot is recorded. Deviations are filed in the bench; the truth is drawn from them.
  struct Recording {
    double noise_rms = 4e-6;
    NoiseColour colour = NoiseColour::white;
    double noise_correlation = 0.0;  ///< of neighbouring samples, of noise that is else white
    double gain_sd = 0.0;
    double position_sd_m = 0.0;
    int bits = 16;
    double range_strain = 0.01;
  };

  explicit BarShots(const Setup& setup);

  /// Peaks are spread evenly from 1000 to 3000 microstrain; one draw of gains and positions for
  /// all.
  [[nodiscard]] std::vector<Shot> draw(std::size_t count, const Recording& recording,
                                       std::mt19937_64& random) const;

  /// Strain at a gauge without noise, for a peak stress of E1 at the impacted end.
  [[nodiscard]] const std::vector<double>& strain(std::size_t gauge) const {
    return strain_[gauge];
  }
  [[nodiscard]] const Setup& setup() const { return setup_; }
  [[nodiscard]] Bench bench(const Recording& recording) const;

 private:
  Setup setup_;
  std::vector<std::vector<double>> strain_;
  std::vector<std::vector<double>> gradient_;   ///< along the bar [1/m]
  std::vector<std::vector<double>> curvature_;  ///< [1/m2]
};

}  // namespace kolsky::testing

#pragma once

#include <array>
#include <optional>
#include <random>
#include <vector>

#include "processing/base/shot.hpp"
#include "tests/generators/bar_world.hpp"
#include "tests/generators/noise.hpp"
#include "tests/generators/table4.hpp"
#include "tests/generators/unit_source.hpp"

namespace kolsky::testing {

/// Ten shots on a bar of 20 mm by 2 m with lateral inertia, four gauges, a free end: solved once as
/// an axisymmetric solid (bar2d), which knows nothing of wave theory. Draws move gauges by the
/// solution's own differences along the bar, misfile gains, add 4 microstrain of noise and quantise
/// to 16 bits.
class SolidBarShots {
 public:
  static constexpr std::size_t kShots = 10;
  static constexpr std::size_t kGauges = 4;

  struct Tolerances {
    double gain_sd = 0.01;
    double position_sd_m = 0.2e-3;
  };

  explicit SolidBarShots(const PublishedPmma& bar);

  /// Peaks from 1000 to 3000 microstrain; one draw of gains and places for all.
  [[nodiscard]] std::vector<Shot> draw(const Tolerances& tolerances, std::mt19937_64& random,
                                       NoiseColour colour = NoiseColour::white) const;

  [[nodiscard]] const std::array<double, 3>& truth() const { return truth_; }

  /// The bound of Cramer and Rao on the relative deviations of E1, E2, eta2 from all shots: sources
  /// (a bell every 4 us) and offsets free, gains and places known within their tolerances. From the
  /// records' own differences by the moduli: four solutions, the first time it is asked for.
  /// @param colour  its covariance is taken for known; not measured
  [[nodiscard]] std::array<double, 3> bound(const Tolerances& tolerances,
                                            NoiseColour colour = NoiseColour::white) const;

 private:
  BarWorld world_;  ///< three stations a gauge: before, at and behind its place
  /// What bounds are made from.
  struct Beside {
    std::array<Readings, 3> moved;  ///< E1, E2, eta2 each by a little
    Responses responses;
  };

  std::array<double, 3> truth_{};
  Readings readings_;
  mutable std::optional<Beside> beside_;
};

}  // namespace kolsky::testing

#pragma once

#include <list>

#include "tests/generators/bar_world.hpp"

namespace kolsky::testing {

/// A specimen as it really is; equilibrium and a linear three-element solid where all is at its
/// default.
struct TrueSpecimen {
  double length_m = 0.004;
  double diameter_m = 0.012;
  double density_kg_m3 = 1140.0;
  double poisson_ratio = 0.376;
  double E1_Pa = 121e6;
  double E2_Pa = 143e6;
  double eta2_Pa_s = 2860.0;
  double relaxation_per_Pa = 0.0;
  double relaxation_time_s = 100e-6;
  double nonlinearity = 0.0;    ///< spring E1 (1 + b strain)
  double inertia = 0.0;         ///< s: a layer of density s rho
  double radial_inertia = 0.0;  ///< s
  double friction = 0.0;        ///< mu, with current sizes at constant volume
  double gap_m = 0.0;
  bool dry = false;       ///< faces push and never pull; else a gap that closed stays so
  double punching = 0.0;  ///< s
  double permanent_strain =
      0.0;  ///< withheld: share of the spring's strain that stays when unloading
  double softening_m3_per_J =
      0.0;  ///< withheld: spring E1/(1 + c work done on it), as if it warmed
  double face_layer_m_per_N = 0.0;  ///< withheld: lubricant, shortening = c F/(1 + F/100 N)
  bool solid = false;  ///< a solid of revolution with its mass and friction at its faces, in place
                       ///< of what the effects' definitions make of them

  [[nodiscard]] double area_m2() const;
  [[nodiscard]] KelvinChain chain() const;
  /// Whether it has what is made only where it deforms alike throughout: waves cross a specimen of
  /// its own mass as they cross a rod.
  [[nodiscard]] bool asks_for_equilibrium() const;
};

/// Two bars and a specimen. `base` holds the input bar, the gauges of both bars, sensors, shots and
/// timing; a source's bells are stress at the impacted end.
struct ShpbWorld {
  BarWorld base;
  double output_length_m = 0.7;
  TrueSpecimen specimen;
};

void plant(ShpbWorld& world, const HiddenEffect& effect);

/// What happened in the specimen, at the step of the calculation.
struct SpecimenHistory {
  double step_s = 0.0;
  std::vector<double> force_N, strain;
};

/// Strain at every station of all gauges, in their order: [shot][station].
struct WaveRecords {
  std::vector<double> step_s;
  std::vector<std::vector<std::vector<double>>> strain;
};

struct ShpbNumerics {
  double step_s = 0.25e-6;
};

/// Both bars by characteristics with the specimen between them solved at every step; free outer
/// ends, or at the output bar's a dashpot that takes end_r of a wave.
[[nodiscard]] Readings shpb_readings(const ShpbWorld& world, const ShpbNumerics& numerics = {},
                                     std::vector<SpecimenHistory>* histories = nullptr);

/// The same with the waves kept between calls, so that a change of sensors costs no new ones.
class ShpbForward {
 public:
  [[nodiscard]] Readings readings(const ShpbWorld& world);

 private:
  std::list<std::pair<std::vector<double>, WaveRecords>> known_;
};

}  // namespace kolsky::testing

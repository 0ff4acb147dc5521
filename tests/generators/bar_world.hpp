#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/generators/hidden_effect.hpp"
#include "tests/generators/kelvin_chain.hpp"

namespace kolsky::testing {

/// A gauge as it really is. Everything that a bench file states about it is in the bench.
struct TrueGauge {
  std::string name;
  std::string bar = "input";
  double position_m = 0.0;  ///< from the impacted end; on an output bar from the specimen's end
  double gain = 1.0;        ///< reading over what the filed numbers make of the strain
  double length_m = 0.0;
  double delay_s = 0.0;
  double amplifier_tau_s = 0.0;
  double drift_per_s = 0.0;
  double crosstalk = 0.0;  ///< share of a neighbouring channel's reading ...
  int crosstalk_from = 0;  ///< ... of that number, from 1; 0: the next, or the one before the last
  double creep = 0.0;      ///< withheld: the adhesive lets this share of the strain go ...
  double creep_time_s = 1e-4;  ///< ... within this time
};

/// What one shot puts in.
struct TrueShot {
  std::vector<double> source;  ///< bells, see UnitSource; scaled so that the first gauge peaks at:
  double peak_strain = 1e-3;
  double temperature_K = 293.15;
  double striker_speed_m_per_s = 0.0;
  std::vector<double> offset;  ///< per gauge, strain
  double hum_phase = 0.0;
  double drift_scale = 1.0;  ///< of this shot's baseline drift
};

/// Hum as the effects define it, with a share of each gauge.
struct TrueHum {
  double amplitude = 0.0;
  double frequency_Hz = 50.0;
  std::vector<double> share;
};

/// How all records are taken.
struct Timing {
  double rate_Hz = 1e6;
  std::size_t samples = 2048;
  std::size_t pretrigger = 300;  ///< samples before the pulse reaches the first gauge
  std::size_t periods_per_knot = 4;
  double lead_s = 400e-6;  ///< the source's first bell begins this long before the record

  [[nodiscard]] double period_s() const { return 1.0 / rate_Hz; }
  [[nodiscard]] double knot_s() const { return static_cast<double>(periods_per_knot) / rate_Hz; }
  [[nodiscard]] double window_s() const {
    return lead_s + static_cast<double>(samples) * period_s();
  }
};

/// The material of a bar with what may be hidden in it.
struct TrueMaterial {
  double E1_Pa = 5.66e9;
  double E2_Pa = 37.0e9;
  double eta2_Pa_s = 1.81e6;
  bool elastic = false;  ///< E1 alone
  double density_kg_m3 = 1180.0;
  double poisson_ratio = 0.36;
  double relaxation_per_Pa = 0.0;
  double relaxation_time_s = 300e-6;
  std::vector<KelvinElement> further_branches{};  ///< each 1/(E + s eta)
  double fluidity_per_Pa_s = 0.0;
  double beta = 1.0;
  double per_kelvin = 0.0;       ///< E1, E2 x (1 - c dT)
  double per_peak_strain = 0.0;  ///< all moduli x (1 + b peak)

  [[nodiscard]] KelvinChain chain(double dT_K, double peak_strain) const;
};

/// A struck bar with gauges, as it really is: the base model where every member is at its default.
struct BarWorld {
  TrueMaterial material;
  double radius_m = 0.010;
  double length_m = 2.0;
  double reference_K = 293.15;
  std::optional<double> end_r;  ///< end-reflection present, R = -1 + r
  bool dispersive = false;      ///< the exact bar in place of the elementary one
  double bending_m = 0.0;
  bool bends_as_deflection = false;
  double bridge_b = 0.0;
  TrueHum hum;
  // Withheld from the library.
  double clamp = 0.0;  ///< area ratio - 1 of a collar 30 mm long
  double clamp_at_m = 0.5;
  double taper = 0.0;              ///< relative change of the area per metre
  double compression_cubic = 0.0;  ///< reading = e (1 - c (e/1e-3)^2)
  double clock_wobble_s = 0.0;     ///< amplitude of a slow wander of the sampling instants
  double clock_period_s = 400e-6;
  Timing timing;
  std::vector<TrueGauge> gauges;
  std::vector<TrueShot> shots;
};

/// Plants an effect. @throws InputError where the kind of bench does not know it
void plant(BarWorld& world, const HiddenEffect& effect);

/// Strain readings without noise, offset or quantisation: [shot][gauge][sample], compression
/// positive, as a digitiser with the filed gains would state them.
using Readings = std::vector<std::vector<std::vector<double>>>;

}  // namespace kolsky::testing

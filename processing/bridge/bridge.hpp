#pragma once

#include <span>
#include <vector>

#include "processing/base/bench.hpp"

namespace kolsky {

/// Turns one gauge's readings into axial strain of the bar, compression positive.
///
/// The exact bridge equations are inverted; the reading before the shot is taken as the unstrained
/// bridge; readings of an inverted channel are taken with the other sign. For volts v per
/// excitation volt and per gain, e tensile strain, K gauge factor, n Poisson's ratio:
///   quarter      v = K e / (4 + 2 K e)
///   half         v = K e / (2 + K e)               (opposite arms)
///   half_poisson v = K e (1 + n) / (4 + 2 K e (1 - n))
///   full_poisson v = K e (1 + n) / (2 + K e (1 - n))
/// where K is reduced by the leads' share of the active arm.
///
/// A semiconductor's factor grows with strain: with dR/R = (K + C e) e of each gauge, transverse
/// ones at -n e, the same bridges give v = (K p1 e + C p2 e^2) / (q0 + K q1 e + C q2 e^2). Its
/// inverse is NaN where no strain gives that reading.
class BridgeConversion {
 public:
  /// @throws InputError whose place is the key in the gauge's table
  BridgeConversion(const Gauge& gauge, const Bar& bar, PositiveSense positive);

  /// @param reading  in the gauge's unit, less the reading of the unstrained bridge
  /// @return strain, compression positive
  [[nodiscard]] double strain(double reading) const;

  /// reading -> strain over a record; `unstrained` is subtracted first.
  void convert(std::span<const double> readings, double unstrained,
               std::span<double> strains) const;

  /// The inverse of `strain`.
  [[nodiscard]] double reading(double strain) const;

  /// d(strain)/d(reading) at zero.
  [[nodiscard]] double sensitivity() const { return sensitivity_; }

  /// Gain in force: filed, or from the shunt calibration.
  [[nodiscard]] double gain() const { return gain_; }

 private:
  // reading = full_scale * a e / (1 + b e), e tensile
  double full_scale_ = 1.0;
  double a_ = 1.0;
  double b_ = 0.0;
  // and beyond a linear gauge, reading = full_scale * (a e + a2 e^2) / (1 + b e + b2 e^2)
  double a2_ = 0.0;
  double b2_ = 0.0;
  double sign_ = 1.0;
  double gain_ = 1.0;
  double sensitivity_ = 1.0;
};

}  // namespace kolsky

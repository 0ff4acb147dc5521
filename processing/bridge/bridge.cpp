#include "processing/bridge/bridge.hpp"

#include <cmath>
#include <string>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

/// reading = excitation * gain * (a e + a2 e^2) / (1 + b e + b2 e^2), e tensile, of a bridge whose
/// arms are free of leads.
struct Equation {
  double a;
  double b;
  double a2;
  double b2;
};

/// @param growth  of the gauge factor with strain
Equation equation_of(BridgeWiring wiring, double gauge_factor, double growth,
                     double poisson_ratio) {
  const double K = gauge_factor;
  const double C = growth;
  const double n = poisson_ratio;
  switch (wiring) {
    case BridgeWiring::quarter:
      return {K / 4.0, K / 2.0, C / 4.0, C / 2.0};
    case BridgeWiring::half:
      return {K / 2.0, K / 2.0, C / 2.0, C / 2.0};
    case BridgeWiring::half_poisson:
      return {K * (1.0 + n) / 4.0, K * (1.0 - n) / 2.0, C * (1.0 - n * n) / 4.0,
              C * (1.0 + n * n) / 2.0};
    case BridgeWiring::full_poisson:
      return {K * (1.0 + n) / 2.0, K * (1.0 - n) / 2.0, C * (1.0 - n * n) / 2.0,
              C * (1.0 + n * n) / 2.0};
  }
  return {};
}

/// Share of the active arm's resistance that is gauge, not wire: its relative change shrinks by
/// this. Three wires put one of them in the neighbouring arm, so that only one is in the active
/// one.
double active_share(const Bridge& bridge) {
  if (bridge.lead_resistance_ohm == 0.0) {
    return 1.0;
  }
  const double gauge_ohm = bridge.gauge_resistance_ohm * bridge.gauges_in_series;
  const double wires_in_arm = bridge.lead_wires == 3 ? 1.0 : 2.0;
  return gauge_ohm / (gauge_ohm + wires_in_arm * bridge.lead_resistance_ohm);
}

void require(bool good, const char* key, const char* what, const char* mend) {
  if (!good) {
    throw InputError(key, what, mend);
  }
}

void check(const Bridge& bridge) {
  require(bridge.gauge_factor > 0.0, "gauge_factor", "is not positive",
          "give the factor of the gauge's data sheet, about 2 for foil");
  require(bridge.excitation_V > 0.0, "excitation_V", "is not positive",
          "give the bridge's supply in volts");
  require(bridge.gain > 0.0, "gain", "is not positive", "give the amplifier's gain, 1 for none");
  require(bridge.gauges_in_series >= 1, "gauges_in_series", "is less than one",
          "give 1, or 2 for a pair across the bar");
  require(bridge.lead_wires == 2 || bridge.lead_wires == 3, "lead_wires", "is neither 2 nor 3",
          "give the number of wires to the gauge");
  require(bridge.lead_resistance_ohm >= 0.0, "lead_resistance_ohm", "is negative",
          "give the resistance of one wire");
  const bool needs_resistance = bridge.lead_resistance_ohm > 0.0 || bridge.shunt_resistance_ohm;
  require(!needs_resistance || bridge.gauge_resistance_ohm > 0.0, "gauge_resistance_ohm",
          "is missing, but leads or a shunt are given",
          "give the resistance of one gauge, as 120.0");
  require(bridge.shunt_resistance_ohm.has_value() == bridge.shunt_reading_V.has_value(),
          "shunt_resistance_ohm", "and shunt_reading_V go together",
          "give both, or neither and the gain");
  require(!bridge.shunt_reading_V || *bridge.shunt_reading_V != 0.0, "shunt_reading_V",
          "is zero: the shunt did nothing", "repeat the shunt calibration");
}

/// The amplifier's gain that makes the shunt's known step read as it did. A shunt across an arm of
/// resistance r lowers it by r / (r + shunt), whatever the other arms are.
double gain_from_shunt(const Bridge& bridge) {
  const double gauge_ohm = bridge.gauge_resistance_ohm * bridge.gauges_in_series;
  const double arm_ohm =
      gauge_ohm + (bridge.lead_wires == 3 ? 1.0 : 2.0) * bridge.lead_resistance_ohm;
  const double shunted_ohm =
      gauge_ohm * *bridge.shunt_resistance_ohm / (gauge_ohm + *bridge.shunt_resistance_ohm);
  const double x = (shunted_ohm - gauge_ohm) / arm_ohm;
  const double volts_per_volt = std::abs(x / (4.0 + 2.0 * x));
  return std::abs(*bridge.shunt_reading_V) / (bridge.excitation_V * volts_per_volt);
}

}  // namespace

BridgeConversion::BridgeConversion(const Gauge& gauge, const Bar& bar, PositiveSense positive)
    : sign_((positive == PositiveSense::compression) != gauge.inverted ? -1.0 : 1.0) {
  if (gauge.unit == "strain") {
    full_scale_ = 1.0 / gauge.strain_gain;
  } else if (gauge.strain_per_V) {
    require(*gauge.strain_per_V != 0.0, "strain_per_V", "is zero", "give strain per volt");
    full_scale_ = 1.0 / *gauge.strain_per_V;
  } else if (gauge.bridge) {
    const Bridge& bridge = *gauge.bridge;
    check(bridge);
    gain_ = bridge.shunt_resistance_ohm ? gain_from_shunt(bridge) * bridge.shunt_gain
                                        : bridge.gain.value;
    const double share = active_share(bridge);
    const Equation equation =
        equation_of(bridge.wiring, bridge.gauge_factor * share,
                    bridge.gauge_factor_per_strain * share, bar.poisson_ratio);
    full_scale_ = bridge.excitation_V * gain_;
    a_ = equation.a;
    b_ = equation.b;
    a2_ = equation.a2;
    b2_ = equation.b2;
  } else {
    throw InputError("unit", "is \"" + gauge.unit + "\" without anything that converts it",
                     "give a bridge or strain_per_V, or unit = \"strain\"");
  }
  sensitivity_ = 1.0 / (full_scale_ * a_);
}

// Inside, strain is tensile and the bridge's own sign is that of tension; outside both are of the
// bench's positive sense, and what leaves is compression positive.
double BridgeConversion::strain(double reading) const {
  const double v = sign_ * reading / full_scale_;
  const double linear = a_ - b_ * v;
  const double square = a2_ - b2_ * v;
  if (square == 0.0) {
    return -v / linear;
  }
  // The root that goes to v / a, in the form that loses no digits.
  const double root = std::copysign(std::sqrt(linear * linear + 4.0 * square * v), linear);
  return -2.0 * v / (linear + root);
}

void BridgeConversion::convert(std::span<const double> readings, double unstrained,
                               std::span<double> strains) const {
  if (a2_ == 0.0 && b2_ == 0.0) {  // as in strain(), without its choice at every sample
    const double per_reading = sign_ / full_scale_;
    for (std::size_t i = 0; i < strains.size(); ++i) {
      const double v = per_reading * (readings[i] - unstrained);
      strains[i] = -v / (a_ - b_ * v);
    }
    return;
  }
  for (std::size_t i = 0; i < strains.size(); ++i) {
    strains[i] = strain(readings[i] - unstrained);
  }
}

double BridgeConversion::reading(double strain) const {
  const double e = -strain;
  return sign_ * full_scale_ * (a_ + a2_ * e) * e / (1.0 + (b_ + b2_ * e) * e);
}

}  // namespace kolsky

// Against a bridge solved as a circuit of four resistors, two voltage dividers on one supply.
#include "processing/bridge/bridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {
namespace {

constexpr double kGaugeFactor = 2.1;
constexpr double kPoisson = 0.36;
constexpr double kSupply_V = 2.0;
constexpr double kGain = 500.0;
constexpr double kOhm = 120.0;

Gauge gauge_with(Bridge bridge) {
  Gauge gauge;
  gauge.unit = "V";
  bridge.gauge_factor = {kGaugeFactor};
  bridge.excitation_V = {kSupply_V};
  bridge.gain = {kGain};
  bridge.gauge_resistance_ohm = kOhm;
  gauge.bridge = bridge;
  return gauge;
}

Bar pmma_bar() {
  Bar bar;
  bar.poisson_ratio = {kPoisson};
  return bar;
}

/// Amplified output of the dividers r1-r2 and r4-r3, positive when r1 grows.
double circuit_V(double r1, double r2, double r3, double r4) {
  return kSupply_V * kGain * (r1 / (r1 + r2) - r4 / (r3 + r4));
}

double stretched(double strain) {
  return kOhm * (1.0 + kGaugeFactor * strain);
}

/// A semiconductor's: dR/R = (120 + 4000 e) e.
double bent(double strain) {
  return kOhm * (1.0 + (120.0 + 4000.0 * strain) * strain);
}

Gauge semiconductor(BridgeWiring wiring) {
  Gauge gauge = gauge_with({.wiring = wiring});
  gauge.bridge->gauge_factor = {120.0};
  gauge.bridge->gauge_factor_per_strain = {4000.0};
  return gauge;
}

class BridgeAtStrain : public ::testing::TestWithParam<double> {};

TEST_P(BridgeAtStrain, QuarterIsTheCircuit) {
  const double e = GetParam();
  const BridgeConversion bridge(gauge_with({}), pmma_bar(), PositiveSense::tension);
  const double volts = circuit_V(stretched(e), kOhm, kOhm, kOhm);
  EXPECT_NEAR(bridge.strain(volts), -e, 1e-14);
  EXPECT_NEAR(bridge.reading(-e), volts, 1e-10);
}

TEST_P(BridgeAtStrain, SemiconductorsAreTheCircuitInEveryWiring) {
  const double e = GetParam() / 10.0;  // to 3000 microstrain, beyond which the factor turns round
  const double t = -kPoisson * e;
  const std::pair<BridgeWiring, double> cases[] = {
      {BridgeWiring::quarter, circuit_V(bent(e), kOhm, kOhm, kOhm)},
      {BridgeWiring::half, circuit_V(bent(e), kOhm, bent(e), kOhm)},
      {BridgeWiring::half_poisson, circuit_V(bent(e), bent(t), kOhm, kOhm)},
      {BridgeWiring::full_poisson, circuit_V(bent(e), bent(t), bent(e), bent(t))}};
  for (const auto& [wiring, volts] : cases) {
    const BridgeConversion bridge(semiconductor(wiring), pmma_bar(), PositiveSense::tension);
    EXPECT_NEAR(bridge.strain(volts), -e, 1e-13) << static_cast<int>(wiring);
    EXPECT_NEAR(bridge.reading(-e), volts, 1e-9 * (1.0 + std::abs(volts)));
  }
}

TEST(Bridge, AReadingThatNoStrainGivesIsNoNumber) {
  // The least that (120 + 4000 e) e can be is -0.9, at e = -0.015.
  const BridgeConversion bridge(semiconductor(BridgeWiring::quarter), pmma_bar(),
                                PositiveSense::tension);
  const double least_V = circuit_V(kOhm * 0.1, kOhm, kOhm, kOhm);
  EXPECT_FALSE(std::isnan(bridge.strain(0.99 * least_V)));
  EXPECT_TRUE(std::isnan(bridge.strain(1.01 * least_V)));
}

TEST_P(BridgeAtStrain, HalfWithOppositeArmsIsTheCircuit) {
  const double e = GetParam();
  const BridgeConversion bridge(gauge_with({.wiring = BridgeWiring::half}), pmma_bar(),
                                PositiveSense::tension);
  EXPECT_NEAR(bridge.strain(circuit_V(stretched(e), kOhm, stretched(e), kOhm)), -e, 1e-14);
}

TEST_P(BridgeAtStrain, HalfWithATransverseGaugeIsTheCircuit) {
  const double e = GetParam();
  const BridgeConversion bridge(gauge_with({.wiring = BridgeWiring::half_poisson}), pmma_bar(),
                                PositiveSense::tension);
  EXPECT_NEAR(bridge.strain(circuit_V(stretched(e), stretched(-kPoisson * e), kOhm, kOhm)), -e,
              1e-14);
}

TEST_P(BridgeAtStrain, FullIsTheCircuit) {
  const double e = GetParam();
  const BridgeConversion bridge(gauge_with({.wiring = BridgeWiring::full_poisson}), pmma_bar(),
                                PositiveSense::tension);
  const double volts =
      circuit_V(stretched(e), stretched(-kPoisson * e), stretched(e), stretched(-kPoisson * e));
  EXPECT_NEAR(bridge.strain(volts), -e, 1e-14);
}

TEST_P(BridgeAtStrain, LeadsOfTwoAndThreeWiresAreTheCircuit) {
  const double e = GetParam();
  constexpr double kLead = 1.7;
  // The bridge was balanced with its leads on: the other arm of the divider carries as much.
  const BridgeConversion two(gauge_with({.lead_resistance_ohm = kLead, .lead_wires = 2}),
                             pmma_bar(), PositiveSense::tension);
  EXPECT_NEAR(two.strain(circuit_V(stretched(e) + 2 * kLead, kOhm + 2 * kLead, kOhm, kOhm)), -e,
              1e-14);
  const BridgeConversion three(gauge_with({.lead_resistance_ohm = kLead, .lead_wires = 3}),
                               pmma_bar(), PositiveSense::tension);
  EXPECT_NEAR(three.strain(circuit_V(stretched(e) + kLead, kOhm + kLead, kOhm, kOhm)), -e, 1e-14);
}

TEST_P(BridgeAtStrain, APairInSeriesAcrossTheBarCancelsBending) {
  const double e = GetParam();
  constexpr double kBending = 300e-6;
  const BridgeConversion bridge(gauge_with({.gauges_in_series = 2}), pmma_bar(),
                                PositiveSense::tension);
  const double arm = stretched(e + kBending) + stretched(e - kBending);
  EXPECT_NEAR(bridge.strain(circuit_V(arm, 2 * kOhm, kOhm, kOhm)), -e, 1e-14);
}

INSTANTIATE_TEST_SUITE_P(FromCompressionToTension, BridgeAtStrain,
                         ::testing::Values(-0.02, -3000e-6, -1e-6, 1e-6, 1000e-6, 0.02));

TEST(Bridge, CompressionPositiveTurnsTheSignOnce) {
  const BridgeConversion tension(gauge_with({}), pmma_bar(), PositiveSense::tension);
  const BridgeConversion compression(gauge_with({}), pmma_bar(), PositiveSense::compression);
  const double volts = circuit_V(stretched(-1000e-6), kOhm, kOhm, kOhm);
  EXPECT_NEAR(tension.strain(volts), 1000e-6, 1e-14);
  EXPECT_NEAR(compression.strain(-volts), 1000e-6, 1e-14);
}

TEST(Bridge, ARawQuarterBridgeReadsCompressionHighByHalfTheGaugeFactor) {
  // reading = e (1 + b e) with b = GF / 2, in compression positive.
  const BridgeConversion bridge(gauge_with({}), pmma_bar(), PositiveSense::compression);
  const double e = 1e-3;
  const double raw = bridge.reading(e) * bridge.sensitivity();
  EXPECT_NEAR((raw / e - 1.0) / e, kGaugeFactor / 2.0, 5e-3);
}

TEST(Bridge, TheShuntGivesTheGainThatMakesItsStepRight) {
  constexpr double kShunt = 100e3;
  const double shunted = kOhm * kShunt / (kOhm + kShunt);
  const double step_V = circuit_V(shunted, kOhm, kOhm, kOhm);  // at the true gain of 500
  Bridge wiring{.shunt_resistance_ohm = kShunt, .shunt_reading_V = step_V};
  Gauge gauge = gauge_with(wiring);
  gauge.bridge->gain = {470.0};  // what the amplifier's dial says
  const BridgeConversion bridge(gauge, pmma_bar(), PositiveSense::tension);
  EXPECT_NEAR(bridge.gain(), kGain, 1e-9);
}

TEST(Bridge, AShuntsDeviationTakesThePlaceOfExcitationAndGain) {
  Gauge gauge = gauge_with({.shunt_resistance_ohm = 100e3, .shunt_reading_V = 1.0});
  gauge.bridge->gauge_factor = {2.0, 0.02};
  gauge.bridge->excitation_V = {5.0, 0.5};
  gauge.bridge->gain = {500.0, 50.0};
  gauge.bridge->shunt_gain.sd = 0.03;
  EXPECT_NEAR(gain_sd(gauge), std::hypot(0.01, 0.03), 1e-12);
  const double before = BridgeConversion(gauge, pmma_bar(), PositiveSense::tension).gain();
  gauge.bridge->shunt_gain.value = 1.02;
  EXPECT_NEAR(BridgeConversion(gauge, pmma_bar(), PositiveSense::tension).gain(), 1.02 * before,
              1e-9 * before);
}

TEST(Bridge, ConvertsWholeRecordsLessTheUnstrainedReading) {
  Gauge gauge;
  gauge.unit = "V";
  gauge.strain_per_V = Measured{5.01e-4};
  const BridgeConversion bridge(gauge, pmma_bar(), PositiveSense::compression);
  const std::vector<double> volts = {0.1, 1.1, -0.9};
  std::vector<double> strains(3);
  bridge.convert(volts, 0.1, strains);
  EXPECT_NEAR(strains[0], 0.0, 1e-18);
  EXPECT_NEAR(strains[1], 5.01e-4, 1e-16);
  EXPECT_NEAR(strains[2], -5.01e-4, 1e-16);
}

TEST(Bridge, StrainPassesThrough) {
  Gauge gauge;
  gauge.unit = "strain";
  EXPECT_EQ(BridgeConversion(gauge, pmma_bar(), PositiveSense::compression).strain(1e-3), 1e-3);
  EXPECT_EQ(BridgeConversion(gauge, pmma_bar(), PositiveSense::tension).strain(1e-3), -1e-3);
}

// Signal or excitation leads exchanged: the circuit's output with the other sign.
TEST(Bridge, OfAnInvertedChannelIsTheCircuitWithItsSignTurned) {
  Gauge gauge = gauge_with({.wiring = BridgeWiring::quarter});
  gauge.inverted = true;
  const BridgeConversion bridge(gauge, pmma_bar(), PositiveSense::tension);
  for (const double tensile : {-0.02, -1e-4, 1e-4, 0.02}) {
    const double exchanged_V = -circuit_V(stretched(tensile), kOhm, kOhm, kOhm);
    EXPECT_NEAR(bridge.strain(exchanged_V), -tensile, 1e-14);
    EXPECT_NEAR(bridge.reading(-tensile), exchanged_V, 1e-12);
  }
  Gauge strain;
  strain.unit = "strain";
  strain.inverted = true;
  EXPECT_EQ(BridgeConversion(strain, pmma_bar(), PositiveSense::compression).strain(1e-3), -1e-3);
}

TEST(Bridge, RefusesWhatCannotConvertAndNamesTheKey) {
  const auto place_of = [](const Gauge& gauge) -> std::string {
    try {
      const BridgeConversion bridge(gauge, pmma_bar(), PositiveSense::tension);
    } catch (const InputError& error) {
      return error.place();
    }
    return "accepted";
  };
  Gauge volts_only;
  volts_only.unit = "V";
  EXPECT_EQ(place_of(volts_only), "unit");
  Gauge gauge = gauge_with({});
  gauge.bridge->gauge_factor = {0.0};
  EXPECT_EQ(place_of(gauge), "gauge_factor");
  gauge = gauge_with({.lead_resistance_ohm = 1.0});
  gauge.bridge->gauge_resistance_ohm = 0.0;
  EXPECT_EQ(place_of(gauge), "gauge_resistance_ohm");
  EXPECT_EQ(place_of(gauge_with({.shunt_resistance_ohm = 1e5})), "shunt_resistance_ohm");
  EXPECT_EQ(place_of(gauge_with({.lead_wires = 4})), "lead_wires");
}

}  // namespace
}  // namespace kolsky

#pragma once

#include "tests/generators/bar_world.hpp"

namespace kolsky::testing {

/// Where strain is looked at: once at a point gauge, at five Gauss points along one with a length.
[[nodiscard]] std::vector<double> stations_of(const std::vector<TrueGauge>& gauges);

/// Strain at the stations to what the sensors make of it, as far as that is linear and has a
/// memory: the mean over a gauge, creep of its adhesive, the amplifier's pole. Delays are left to
/// sampling.
[[nodiscard]] std::vector<std::vector<double>> sensed(
    const std::vector<TrueGauge>& gauges, const std::vector<std::vector<double>>& strain,
    double step_s);

/// Sampled strains to readings: wandering clock, bends, gains, drift and hum, then crosstalk.
void apply_sensors(std::vector<std::vector<double>>& records, const BarWorld& world,
                   const TrueShot& shot);

}  // namespace kolsky::testing

#include "processing/base/bench.hpp"

#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"

namespace kolsky {

namespace {

double circle_area_m2(double diameter_m) {
  return std::numbers::pi * diameter_m * diameter_m / 4.0;
}

}  // namespace

double Bar::area_m2() const {
  return circle_area_m2(diameter_m);
}

double Bar::dispersion_radius_m() const {
  if (section == Section::square && side_m) {
    return *side_m / (2.0 * std::numbers::sqrt3);
  }
  return diameter_m / 2.0;
}

double gain_sd(const Gauge& gauge) {
  if (gauge.strain_per_V) {
    return relative_sd(*gauge.strain_per_V);
  }
  if (gauge.bridge) {
    const Bridge& bridge = *gauge.bridge;
    // A shunt's step has the excitation in it.
    const double amplified = bridge.shunt_reading_V ? relative_sd(bridge.shunt_gain)
                                                    : std::hypot(relative_sd(bridge.excitation_V),
                                                                 relative_sd(bridge.gain));
    return std::hypot(relative_sd(bridge.gauge_factor), amplified);
  }
  return relative_sd(gauge.strain_gain);
}

bool Striker::of_material(const Bar& bar) const {
  constexpr double kSameDensity = 0.02;
  return !youngs_modulus_Pa &&
         (!density_kg_m3 || std::abs(*density_kg_m3 / bar.density_kg_m3 - 1.0) <= kSameDensity);
}

double Specimen::area_m2() const {
  return circle_area_m2(diameter_m);
}

const Bar& Bench::bar_of(const Gauge& gauge) const {
  return gauge.bar == "output" && output ? *output : input;
}

double Bench::distance_to_specimen_m(const Gauge& gauge) const {
  return gauge.bar == "output" ? gauge.position_m.value : input.length_m - gauge.position_m;
}

std::vector<BenchChannel> Bench::channels() const {
  std::vector<BenchChannel> list;
  for (const Gauge& gauge : gauges) {
    list.push_back({gauge.name, gauge.unit});
  }
  for (const PhotoSensor& sensor : photo_sensors) {
    list.push_back({sensor.name, "V"});
  }
  return list;
}

bool all_elastic(const Bench& bench) {
  return bench.input.youngs_modulus_Pa && (!bench.output || bench.output->youngs_modulus_Pa);
}

bool takes_bar_model(const Bench& bench) {
  return bench.input.takes_bar_model() || (bench.output && bench.output->takes_bar_model());
}

const Bar& bar_named(const Bench& bench, const std::string& name) {
  if (name == "input") {
    return bench.input;
  }
  if (name == "output" && bench.output) {
    return *bench.output;
  }
  throw InputError("bar", "\"" + name + "\" is not a bar of this bench",
                   bench.output ? "give input or output" : "give input: there is no other");
}

}  // namespace kolsky

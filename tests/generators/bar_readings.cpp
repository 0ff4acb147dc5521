#include "tests/generators/bar_readings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "tests/generators/bar2d.hpp"
#include "tests/generators/beam.hpp"
#include "tests/generators/interpolation.hpp"
#include "tests/generators/sensor_records.hpp"

namespace kolsky::testing {

namespace {

constexpr std::size_t kKept = 40;

std::function<double(double)> area_of(const BarWorld& world) {
  if (world.clamp == 0.0 && world.taper == 0.0) {
    return {};
  }
  return [world](double x) {
    constexpr double kCollar_m = 0.03;
    const bool clamped = std::abs(x - world.clamp_at_m) < 0.5 * kCollar_m;
    return std::clamp(1.0 + world.taper * x, 0.2, 5.0) * (clamped ? 1.0 + world.clamp : 1.0);
  };
}

BarProblem problem_of(const BarWorld& world, const KelvinChain& chain) {
  BarProblem problem{.material = chain,
                     .density_kg_m3 = world.material.density_kg_m3,
                     .stations_m = stations_of(world.gauges),
                     .far_end = {},
                     .relative_area = area_of(world),
                     .window_s = world.timing.window_s()};
  if (world.end_r) {
    problem.far_end = FarEndReturn{world.length_m, *world.end_r};
  }
  return problem;
}

SolidBarProblem solid_problem_of(const BarWorld& world, const KelvinChain& chain) {
  if (world.clamp != 0.0 || world.taper != 0.0 || world.end_r.value_or(0.0) != 0.0) {
    throw InputError("--effect geometric-dispersion",
                     "goes with uniform bars that end freely or not at all",
                     "leave the other effect out, or make the reflection 0");
  }
  SolidBarProblem problem{chain,
                          world.material.density_kg_m3,
                          world.material.poisson_ratio,
                          world.radius_m,
                          stations_of(world.gauges),
                          {},
                          world.timing.window_s()};
  if (world.end_r) {
    problem.free_end_m = world.length_m;
  }
  return problem;
}

std::vector<double> key_numbers(const BarWorld& world, const KelvinChain& chain) {
  std::vector<double> numbers{chain.glassy_Pa,         world.material.density_kg_m3,
                              world.radius_m,          world.material.poisson_ratio,
                              world.timing.window_s(), world.timing.knot_s()};
  for (const KelvinElement& element : chain.elements) {
    numbers.insert(numbers.end(), {element.stiffness_Pa, element.viscosity_Pa_s});
  }
  const std::vector<double> places = stations_of(world.gauges);
  numbers.insert(numbers.end(), places.begin(), places.end());
  return numbers;
}

double peak(const std::vector<double>& record) {
  double largest = 0.0;
  for (const double value : record) {
    largest = std::max(largest, std::abs(value));
  }
  return largest;
}

}  // namespace

const Responses& BarForward::remembered(const Key& key, const std::function<Responses()>& reckon) {
  for (const auto& [known, responses] : known_) {
    if (known == key) {
      return responses;
    }
  }
  if (known_.size() >= kKept) {
    known_.pop_front();
  }
  known_.emplace_back(key, reckon());
  return known_.back().second;
}

const Responses& BarForward::wave_responses(const BarWorld& world, const KelvinChain& chain) {
  Key key{key_numbers(world, chain)};
  key.numbers.insert(key.numbers.end(),
                     {world.length_m, world.end_r.value_or(-1.0), world.clamp, world.clamp_at_m,
                      world.taper, world.dispersive ? 1.0 : 0.0});
  return remembered(key, [&] {
    const UnitSource source{world.timing.knot_s()};
    return world.dispersive ? solid_bar_response(solid_problem_of(world, chain), source)
                            : bar_response(problem_of(world, chain), source);
  });
}

const Responses& BarForward::bending_responses(const BarWorld& world, const KelvinChain& chain) {
  Key key{key_numbers(world, chain)};
  key.numbers.push_back(world.bends_as_deflection ? -2.0 : -1.0);
  return remembered(key, [&] {
    return beam_response(
        {chain, world.material.density_kg_m3, world.material.poisson_ratio, world.radius_m,
         stations_of(world.gauges), world.timing.window_s(), world.bends_as_deflection},
        {world.timing.knot_s()});
  });
}

Responses BarForward::sensor_responses(const BarWorld& world, const TrueShot& shot) {
  const KelvinChain chain =
      world.material.chain(shot.temperature_K - world.reference_K, shot.peak_strain);
  Responses waves = wave_responses(world, chain);
  if (world.bending_m != 0.0) {
    const Responses& bending = bending_responses(world, chain);
    for (std::size_t i = 0; i < waves.strain.size(); ++i) {
      for (std::size_t n = 0; n < waves.strain[i].size(); ++n) {
        waves.strain[i][n] += world.bending_m * bending.strain[i][n];
      }
    }
  }
  return {waves.step_s, sensed(world.gauges, waves.strain, waves.step_s)};
}

Readings BarForward::readings(const BarWorld& world) {
  const Timing& timing = world.timing;
  Readings all;
  for (const TrueShot& shot : world.shots) {
    const Responses responses = sensor_responses(world, shot);
    std::vector<std::vector<double>> records;
    for (std::size_t g = 0; g < world.gauges.size(); ++g) {
      records.push_back(superpose(responses.strain[g], responses.step_s, shot.source,
                                  timing.periods_per_knot, timing.period_s(),
                                  world.gauges[g].delay_s - timing.lead_s, timing.samples));
    }
    const double scale = shot.peak_strain / peak(records.front());
    for (std::size_t g = 0; g < records.size(); ++g) {
      for (double& value : records[g]) {
        value *= scale;
      }
    }
    apply_sensors(records, world, shot);
    all.push_back(std::move(records));
  }
  return all;
}

}  // namespace kolsky::testing

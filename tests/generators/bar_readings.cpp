#include "tests/generators/bar_readings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "processing/base/error.hpp"
#include "tests/generators/bar2d.hpp"
#include "tests/generators/beam.hpp"
#include "tests/generators/interpolation.hpp"
#include "tests/generators/sensor_chain.hpp"

namespace kolsky::testing {

namespace {

constexpr std::size_t kKept = 40;
constexpr int kFiner = 8;

// Where the wave is looked at: once at a point gauge, five times along one with a length.
std::vector<double> stations(const BarWorld& world) {
  std::vector<double> places;
  for (const TrueGauge& gauge : world.gauges) {
    if (gauge.length_m == 0.0) {
      places.push_back(gauge.position_m);
      continue;
    }
    for (const double place : gauss_five().place) {
      places.push_back(gauge.position_m + place * gauge.length_m);
    }
  }
  return places;
}

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
                     .stations_m = stations(world),
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
                          stations(world),
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
  const std::vector<double> places = stations(world);
  numbers.insert(numbers.end(), places.begin(), places.end());
  return numbers;
}

std::vector<double> finer(const std::vector<double>& history) {
  std::vector<double> out((history.size() - 1) * kFiner + 1);
  for (std::size_t n = 0; n < out.size(); ++n) {
    out[n] = sample_at(history, static_cast<double>(n) / kFiner);
  }
  return out;
}

std::vector<double> every(const std::vector<double>& history, std::size_t stride) {
  std::vector<double> out;
  for (std::size_t n = 0; n < history.size(); n += stride) {
    out.push_back(history[n]);
  }
  return out;
}

// What the sensor makes of a strain, as far as it is linear and has a memory.
std::vector<double> sensed(const TrueGauge& gauge, const std::vector<double>& strain,
                           double step_s) {
  if (gauge.creep == 0.0 && gauge.amplifier_tau_s == 0.0) {
    return strain;
  }
  std::vector<double> fine = finer(strain);
  if (gauge.creep != 0.0) {
    const std::vector<double> slow = one_pole(fine, step_s / kFiner, gauge.creep_time_s);
    for (std::size_t n = 0; n < fine.size(); ++n) {
      fine[n] -= gauge.creep * slow[n];
    }
  }
  return every(one_pole(fine, step_s / kFiner, gauge.amplifier_tau_s), kFiner);
}

void wander(std::vector<double>& record, const BarWorld& world) {
  const double period_s = world.timing.period_s();
  const std::vector<double> steady = record;
  for (std::size_t n = 0; n < record.size(); ++n) {
    const double t = static_cast<double>(n) * period_s;
    const double shift_s =
        world.clock_wobble_s * std::sin(2.0 * std::numbers::pi * t / world.clock_period_s);
    record[n] = sample_at(steady, static_cast<double>(n) + shift_s / period_s);
  }
}

void distort(std::vector<double>& record, const BarWorld& world) {
  bend(record, world.bridge_b);
  if (world.compression_cubic != 0.0) {
    for (double& value : record) {
      value *= 1.0 - world.compression_cubic * (value / 1e-3) * (value / 1e-3);
    }
  }
}

void add_slow_parts(std::vector<double>& record, const BarWorld& world, const TrueShot& shot,
                    std::size_t gauge) {
  const Timing& timing = world.timing;
  const double drift = world.gauges[gauge].drift_per_s * shot.drift_scale;
  const double share = gauge < world.hum.share.size() ? world.hum.share[gauge] : 1.0;
  for (std::size_t n = 0; n < record.size(); ++n) {
    const double t =
        (static_cast<double>(n) - static_cast<double>(timing.pretrigger)) * timing.period_s();
    record[n] += drift * t;
    record[n] += world.hum.amplitude * share *
                 std::cos(2.0 * std::numbers::pi * world.hum.frequency_Hz * t + shot.hum_phase);
  }
}

void add_crosstalk(std::vector<std::vector<double>>& records, const BarWorld& world) {
  const std::vector<std::vector<double>> clean = records;
  const std::size_t count = records.size();
  for (std::size_t g = 0; g < count; ++g) {
    const TrueGauge& gauge = world.gauges[g];
    if (gauge.crosstalk == 0.0 || count < 2) {
      continue;
    }
    const std::size_t next = g + 1 < count ? g + 1 : g - 1;
    const std::size_t from =
        gauge.crosstalk_from > 0 ? static_cast<std::size_t>(gauge.crosstalk_from) - 1 : next;
    for (std::size_t n = 0; n < records[g].size(); ++n) {
      records[g][n] += gauge.crosstalk * clean[from][n];
    }
  }
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
  key.numbers.push_back(-1.0);
  return remembered(key, [&] {
    return beam_response({chain, world.material.density_kg_m3, world.material.poisson_ratio,
                          world.radius_m, stations(world), world.timing.window_s()},
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
  Responses out{waves.step_s, {}};
  std::size_t station = 0;
  for (const TrueGauge& gauge : world.gauges) {
    std::vector<double> strain = waves.strain[station++];
    if (gauge.length_m != 0.0) {
      std::ranges::transform(strain, strain.begin(),
                             [](double value) { return value * gauss_five().weight[0]; });
      for (std::size_t i = 1; i < 5; ++i, ++station) {
        for (std::size_t n = 0; n < strain.size(); ++n) {
          strain[n] += gauss_five().weight[i] * waves.strain[station][n];
        }
      }
    }
    out.strain.push_back(sensed(gauge, strain, waves.step_s));
  }
  return out;
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
      if (world.clock_wobble_s != 0.0) {
        wander(records[g], world);
      }
      distort(records[g], world);
      for (double& value : records[g]) {
        value *= world.gauges[g].gain;
      }
      add_slow_parts(records[g], world, shot, g);
    }
    add_crosstalk(records, world);
    all.push_back(std::move(records));
  }
  return all;
}

}  // namespace kolsky::testing

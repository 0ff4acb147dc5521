#include "tests/generators/sensor_records.hpp"

#include <cmath>
#include <numbers>

#include "tests/generators/interpolation.hpp"
#include "tests/generators/sensor_chain.hpp"

namespace kolsky::testing {

namespace {

constexpr int kFiner = 8;

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
std::vector<double> sensed_by(const TrueGauge& gauge, const std::vector<double>& strain,
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

}  // namespace

std::vector<double> stations_of(const std::vector<TrueGauge>& gauges) {
  std::vector<double> places;
  for (const TrueGauge& gauge : gauges) {
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

std::vector<std::vector<double>> sensed(const std::vector<TrueGauge>& gauges,
                                        const std::vector<std::vector<double>>& strain,
                                        double step_s) {
  std::vector<std::vector<double>> out;
  std::size_t station = 0;
  for (const TrueGauge& gauge : gauges) {
    std::vector<double> mean = strain[station];
    if (gauge.length_m != 0.0) {
      std::fill(mean.begin(), mean.end(), 0.0);
      for (std::size_t i = 0; i < gauss_five().weight.size(); ++i) {
        for (std::size_t n = 0; n < mean.size(); ++n) {
          mean[n] += gauss_five().weight[i] * strain[station + i][n];
        }
      }
    }
    station += gauge.length_m == 0.0 ? 1 : gauss_five().weight.size();
    out.push_back(sensed_by(gauge, mean, step_s));
  }
  return out;
}

void apply_sensors(std::vector<std::vector<double>>& records, const BarWorld& world,
                   const TrueShot& shot) {
  for (std::size_t g = 0; g < records.size(); ++g) {
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
}

}  // namespace kolsky::testing

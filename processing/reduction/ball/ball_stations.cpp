#include "processing/reduction/ball/ball_stations.hpp"

#include <algorithm>
#include <numeric>

namespace kolsky {

std::vector<BarStation> stations_by_position(const Bench& bench) {
  std::vector<std::size_t> order(bench.gauges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return bench.gauges[a].position_m.value < bench.gauges[b].position_m.value;
  });
  std::vector<BarStation> stations;
  double first_m = 0.0;
  for (const std::size_t i : order) {
    const double position_m = bench.gauges[i].position_m;
    if (stations.empty() || position_m - first_m > bench.input.diameter_m) {
      stations.emplace_back();
      first_m = position_m;
    }
    stations.back().channels.push_back(i);
  }
  for (BarStation& station : stations) {
    double sum_m = 0.0;
    for (const std::size_t i : station.channels) {
      sum_m += bench.gauges[i].position_m;
    }
    station.gauge_to_specimen_m = sum_m / static_cast<double>(station.channels.size());
    station.gauge_to_far_end_m = bench.input.length_m - station.gauge_to_specimen_m;
  }
  return stations;
}

std::string names_of(const BarStation& station, const Bench& bench) {
  std::string names;
  for (const std::size_t i : station.channels) {
    names += (names.empty() ? "" : "+") + bench.gauges[i].name;
  }
  return names;
}

double gain_sd(const Gauge& gauge, double strain) {
  if (!gauge.bridge) {
    return gain_sd(gauge);
  }
  const Bridge& bridge = *gauge.bridge;
  return std::hypot(gain_sd(gauge),
                    bridge.gauge_factor_per_strain.sd * strain / bridge.gauge_factor);
}

}  // namespace kolsky

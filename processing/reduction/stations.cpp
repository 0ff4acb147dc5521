#include "processing/reduction/stations.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/bridge/channel_delay.hpp"

namespace kolsky {

namespace {

double unstrained_reading(const ChannelRecord& channel, std::size_t quiet) {
  double sum = 0.0;
  for (std::size_t n = 0; n < quiet; ++n) {
    sum += channel.codes[n];
  }
  const double mean = quiet > 0 ? sum / static_cast<double>(quiet) : 0.0;
  return (mean + channel.offset) * channel.scale;
}

/// The mean of what `add` gives of each gauge, on the bench's clock.
template <class Add>
void add_each(const Shot& shot, const BarStation& station, std::vector<double>& sum, Add add) {
  std::fill(sum.begin(), sum.end(), 0.0);
  const double share = 1.0 / static_cast<double>(station.channels.size());
  for (const std::size_t index : station.channels) {
    if (const double delay_s = shot.bench.gauges[index].delay_s; delay_s != 0.0) {
      std::vector<double> own(sum.size(), 0.0);
      add(index, 1.0, own);
      take_out_delay(delay_s, shot.rate.Hz(), own);
      std::transform(own.begin(), own.end(), sum.begin(), sum.begin(),
                     [share](double value, double rest) { return rest + share * value; });
    } else {
      add(index, share, sum);
    }
  }
}

}  // namespace

BarStation station_on(const Bench& bench, const std::string& bar) {
  BarStation station;
  const Gauge* first = nullptr;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    if (gauge.bar != bar) {
      continue;
    }
    if (first == nullptr) {
      first = &gauge;
    }
    if (std::abs(gauge.position_m - first->position_m) <= bench.bar_of(gauge).diameter_m) {
      station.channels.push_back(i);
      station.gauge_to_specimen_m += bench.distance_to_specimen_m(gauge);
    }
  }
  if (first == nullptr) {
    throw InputError("gauges", "none is on the " + bar + " bar",
                     "add one with bar = \"" + bar + "\"");
  }
  station.gauge_to_specimen_m /= static_cast<double>(station.channels.size());
  station.gauge_to_far_end_m = bench.bar_of(*first).length_m - station.gauge_to_specimen_m;
  return station;
}

void read_raw_station(const Shot& shot, const BarStation& station, std::vector<double>& readings) {
  add_each(shot, station, readings, [&](std::size_t index, double share, std::vector<double>& sum) {
    const ChannelRecord& channel = shot.channels[index];
    for (std::size_t n = 0; n < sum.size(); ++n) {
      sum[n] += share * channel.value(channel.codes[n]);
    }
  });
}

void read_station(const Shot& shot, const BarStation& station, std::size_t quiet,
                  std::vector<double>& strains) {
  add_each(shot, station, strains, [&](std::size_t index, double share, std::vector<double>& sum) {
    const ChannelRecord& channel = shot.channels[index];
    const Gauge& gauge = shot.bench.gauges[index];
    const BridgeConversion bridge(gauge, shot.bench.bar_of(gauge), shot.bench.positive);
    const double unstrained = unstrained_reading(channel, quiet);
    std::array<double, 256> readings;
    std::array<double, 256> part;
    for (std::size_t begin = 0; begin < sum.size(); begin += part.size()) {
      const std::size_t count = std::min(part.size(), sum.size() - begin);
      for (std::size_t n = 0; n < count; ++n) {
        readings[n] = channel.value(channel.codes[begin + n]);
      }
      bridge.convert(std::span(readings).first(count), unstrained, std::span(part).first(count));
      for (std::size_t n = 0; n < count; ++n) {
        sum[begin + n] += share * part[n];
      }
    }
  });
}

}  // namespace kolsky

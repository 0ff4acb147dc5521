#include "processing/specimen/shpb_records.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/bridge/channel_delay.hpp"
#include "processing/identification/bar_records.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/record_faults.hpp"

namespace kolsky {

namespace {

constexpr double kLongestQuiet_s = 500e-6;

/// A channel's readings on the bench's clock.
std::vector<double> readings_of(const Shot& shot, std::size_t index) {
  std::vector<double> readings = kolsky::readings_of(shot.channels[index]);
  take_out_delay(shot.bench.gauges[index].delay_s, shot.rate.Hz(), readings);
  return readings;
}

std::vector<double> readings_of(const Shot& shot, const ShpbStation& station) {
  std::vector<double> mean(shot.samples(), 0.0);
  for (const std::size_t index : station.channels) {
    const std::vector<double> own = readings_of(shot, index);
    for (std::size_t n = 0; n < mean.size(); ++n) {
      mean[n] += own[n] / static_cast<double>(station.channels.size());
    }
  }
  return mean;
}

void require_serving(const Shot& shot, const Shot& first) {
  const std::string place = "capture " + shot.id;
  require_specimen(shot);
  if (shot.channels.size() != shot.bench.gauges.size()) {
    throw InputError(place,
                     "has " + std::to_string(shot.channels.size()) + " channels for " +
                         std::to_string(shot.bench.gauges.size()) + " gauges",
                     "file one gauge per channel, in their order");
  }
  if (shot.rate != first.rate || shot.bench_toml != first.bench_toml) {
    throw InputError(place, "is of another bench or rate than " + first.id,
                     "identify a specimen from shots on one bench");
  }
  if (const std::string spoiled = spoiled_because(shot); !spoiled.empty()) {
    throw InputError(place, spoiled, kRepeatOrLeaveOut);
  }
}

FirstPulse pulse_of(const Shot& shot, const ShpbStation& station) {
  const auto pulse = first_pulse(readings_of(shot, station), shot.rate.Hz());
  if (!pulse) {
    throw InputError("capture " + shot.id,
                     "holds no pulse that stands out of the noise of " +
                         shot.bench.gauges[station.channels.front()].name,
                     "give the shot's whole record, from before the impact");
  }
  if (pulse->quiet < kFewestQuiet) {
    throw InputError("capture " + shot.id, too_few_quiet(pulse->quiet), kRecordFromBefore);
  }
  return *pulse;
}

std::vector<double> strain_of(const Shot& shot, const ShpbStation& station, std::size_t first,
                              std::size_t quiet) {
  const std::size_t count = shot.samples() - first;
  std::vector<double> strain(count, 0.0);
  std::vector<double> own(count);
  for (const std::size_t index : station.channels) {
    const Gauge& gauge = shot.bench.gauges[index];
    const std::vector<double> whole = readings_of(shot, index);
    const auto readings = std::span(whole).subspan(first);
    const BridgeConversion bridge(gauge, shot.bench.bar_of(gauge), shot.bench.positive);
    bridge.convert(readings, quiet_before(readings, quiet).baseline, own);
    for (std::size_t n = 0; n < count; ++n) {
      strain[n] += own[n] / static_cast<double>(station.channels.size());
    }
  }
  return strain;
}

}  // namespace

void require_specimen(const Shot& shot) {
  const Bench& bench = shot.bench;
  if (bench.kind != BenchKind::shpb) {
    throw InputError(
        "capture " + shot.id + ": kind", "is not \"shpb\": there is no specimen in it to identify",
        bench.kind == BenchKind::bar ? "`kolsky identify bar` finds what a bar is made of"
                                     : "`kolsky reduce` finds a ball's force and restitution");
  }
  if (!bench.output || !bench.specimen) {
    throw InputError("capture " + shot.id, "is of a bench without a specimen between two bars",
                     "file bars.output and specimen");
  }
}

std::vector<ShpbStation> shpb_stations(const Bench& bench) {
  std::vector<ShpbStation> stations;
  for (std::size_t i = 0; i < bench.gauges.size(); ++i) {
    const Gauge& gauge = bench.gauges[i];
    const bool on_input = gauge.bar == "input";
    const double distance_m = bench.distance_to_specimen_m(gauge);
    const auto same = std::find_if(stations.begin(), stations.end(), [&](const ShpbStation& s) {
      const double first_m = bench.distance_to_specimen_m(bench.gauges[s.channels.front()]);
      return s.on_input == on_input &&
             std::abs(first_m - distance_m) <= bench.bar_of(gauge).diameter_m;
    });
    ShpbStation& station = same != stations.end() ? *same : stations.emplace_back();
    station.on_input = on_input;
    station.channels.push_back(i);
    station.to_specimen_m += distance_m;
  }
  bool has_output = false;
  bool has_input = false;
  for (ShpbStation& station : stations) {
    station.to_specimen_m /= static_cast<double>(station.channels.size());
    (station.on_input ? has_input : has_output) = true;
  }
  if (!has_input || !has_output) {
    const std::string bar = has_input ? "output" : "input";
    throw InputError("gauges", "none is on the " + bar + " bar",
                     "add one with bar = \"" + bar + "\"");
  }
  std::stable_sort(
      stations.begin(), stations.end(), [](const ShpbStation& a, const ShpbStation& b) {
        if (a.on_input != b.on_input) {
          return a.on_input;
        }
        return a.on_input ? a.to_specimen_m > b.to_specimen_m : a.to_specimen_m < b.to_specimen_m;
      });
  return stations;
}

std::vector<ShpbRecords> read_shpb_records(const std::vector<Shot>& shots,
                                           const std::vector<ShpbStation>& stations) {
  std::vector<FirstPulse> pulses;
  const double rate_Hz = shots.front().rate.Hz();
  auto quiet = static_cast<std::size_t>(kLongestQuiet_s * rate_Hz);
  for (const Shot& shot : shots) {
    require_serving(shot, shots.front());
    pulses.push_back(pulse_of(shot, stations.front()));
    quiet = std::min(quiet, pulses.back().quiet);
  }
  std::vector<ShpbRecords> list;
  for (std::size_t i = 0; i < shots.size(); ++i) {
    const std::size_t first = pulses[i].quiet - quiet;
    ShpbRecords records;
    records.quiet_samples = quiet;
    records.foot_s = (pulses[i].foot - static_cast<double>(first)) / rate_Hz;
    for (const ShpbStation& station : stations) {
      records.strain.push_back(strain_of(shots[i], station, first, quiet));
    }
    list.push_back(std::move(records));
  }
  return list;
}

}  // namespace kolsky

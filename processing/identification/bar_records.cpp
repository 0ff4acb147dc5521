#include "processing/identification/bar_records.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky {

namespace {

constexpr double kShortestPulse_s = 5e-6;
constexpr double kFootClearance_s = 10e-6;
constexpr std::size_t kFewestQuiet = 32;

std::vector<double> readings_of(const ChannelRecord& channel) {
  std::vector<double> readings(channel.codes.size());
  std::transform(channel.codes.begin(), channel.codes.end(), readings.begin(),
                 [&](std::int32_t code) { return channel.value(code); });
  return readings;
}

/// Foot of the first pulse in a record, in samples.
double foot_in(const std::vector<double>& readings, double rate_Hz, const std::string& gauge) {
  const auto width = std::max<std::size_t>(3, static_cast<std::size_t>(kShortestPulse_s * rate_Hz));
  const auto reach = static_cast<std::size_t>(500e-6 * rate_Hz);
  const auto rise = find_first_pulse(readings, width, reach);
  if (!rise) {
    throw InputError("gauge " + gauge, "holds no pulse that stands out of its noise",
                     "give the shot's whole record, from before the impact");
  }
  const double baseline =
      quiet_before(readings, std::min<std::size_t>(rise->index, kFewestQuiet)).baseline;
  const std::size_t end = std::min(readings.size(), rise->index + reach);
  std::vector<double> shifted(end);
  for (std::size_t n = 0; n < end; ++n) {
    shifted[n] = rise->sense * (readings[n] - baseline);
  }
  const double peak =
      *std::max_element(shifted.begin() + static_cast<std::ptrdiff_t>(rise->index), shifted.end());
  return foot_of(shifted, rise->index, peak, 0.0).index;
}

void require_bar(const Shot& shot) {
  if (shot.bench.kind != BenchKind::bar) {
    throw InputError("kind", "is not \"bar\"",
                     "characterise a bar with a bench file of kind \"bar\"");
  }
  if (shot.bench.gauges.size() < 2 || shot.channels.size() != shot.bench.gauges.size()) {
    throw InputError("gauges", "are too few: what a bar does to a wave shows between two places",
                     "record the pulse with at least two gauges on the bar");
  }
  const std::string unusable = unusable_because(shot);
  if (!unusable.empty()) {
    throw InputError("samples", unusable, "repeat the shot, or leave this capture out");
  }
}

}  // namespace

BarRecords read_bar_records(const Shot& shot) {
  require_bar(shot);
  const Bench& bench = shot.bench;
  BarRecords records;
  records.period_s = shot.rate.period_s();
  records.channel.resize(bench.gauges.size());
  std::iota(records.channel.begin(), records.channel.end(), std::size_t{0});
  std::sort(records.channel.begin(), records.channel.end(), [&](std::size_t a, std::size_t b) {
    return bench.gauges[a].position_m < bench.gauges[b].position_m;
  });
  const double rate_Hz = shot.rate.Hz();
  const std::size_t first = records.channel.front();
  const double foot = foot_in(readings_of(shot.channels[first]), rate_Hz, bench.gauges[first].name);
  const auto quiet = static_cast<std::size_t>(std::max(0.0, foot - kFootClearance_s * rate_Hz));
  if (quiet < kFewestQuiet) {
    throw InputError(
        "samples", "are too few before the pulse: " + std::to_string(quiet),
        "record at least " + std::to_string(kFewestQuiet) + " quiet samples before it");
  }
  for (const std::size_t index : records.channel) {
    const Gauge& gauge = bench.gauges[index];
    const BridgeConversion bridge(gauge, bench.bar_of(gauge), bench.positive);
    const std::vector<double> readings = readings_of(shot.channels[index]);
    std::vector<double> strain(readings.size());
    bridge.convert(readings, quiet_before(readings, quiet).baseline, strain);
    records.noise_rms.push_back(quiet_before(strain, quiet).noise_rms);
    records.position_m.push_back(gauge.position_m);
    records.strain.push_back(std::move(strain));
  }
  records.quiet_samples = quiet;
  records.foot_s = foot * records.period_s;
  return records;
}

}  // namespace kolsky

#include "processing/identification/bar_records.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/base/error.hpp"
#include "processing/base/range.hpp"
#include "processing/bridge/bridge.hpp"
#include "processing/bridge/channel_delay.hpp"
#include "processing/reduction/code_steps.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"
#include "processing/reduction/record_faults.hpp"

namespace kolsky {

namespace {

FirstPulse require_pulse(const std::vector<double>& readings, double rate_Hz,
                         const std::string& gauge) {
  const auto pulse = first_pulse(readings, rate_Hz);
  if (!pulse) {
    throw InputError("gauge " + gauge, "holds no pulse that stands out of its noise",
                     "give the shot's whole record, from before the impact");
  }
  return *pulse;
}

void require_quiet(std::size_t samples) {
  if (samples < kFewestQuiet) {
    throw InputError("samples", too_few_quiet(samples), kRecordFromBefore);
  }
}

void require_bar(const Shot& shot) {
  const Bench& bench = shot.bench;
  if (bench.kind != BenchKind::bar) {
    throw InputError("kind", "is not \"bar\"",
                     "characterise a bar with a bench file of kind \"bar\"");
  }
  if (bench.gauges.empty() || shot.channels.size() != bench.gauges.size()) {
    throw InputError("gauges", "are not those of the capture's channels",
                     "give the bench file that the shot was recorded with");
  }
  if (const std::string spoiled = spoiled_because(shot); !spoiled.empty()) {
    throw InputError("samples", spoiled, kRepeatOrLeaveOut);
  }
}

/// Channels in the order of their gauges along the bar, which must not all be at one place.
std::vector<std::size_t> along_the_bar(const Bench& bench) {
  std::vector<std::size_t> order(bench.gauges.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return bench.gauges[a].position_m < bench.gauges[b].position_m;
  });
  const double span =
      bench.gauges[order.back()].position_m - bench.gauges[order.front()].position_m;
  if (bench.gauges.size() > 1 && span < bench.input.diameter_m) {
    throw InputError("gauges",
                     "lie within " + in_words(span, "m") +
                         " of each other, too near to show what "
                         "the bar does to a wave",
                     "put gauges at least a diameter of the bar apart, better ten; or give one of "
                     "them by itself, which needs "
                     "a free far end");
  }
  return order;
}

/// Of the converter, in the gauge's unit. A table's codes are the file's; the converter's own,
/// which are coarser, show where a record takes few of them.
double step_of(const ChannelRecord& channel, const std::vector<double>& readings) {
  return std::max(std::abs(channel.scale), code_step(readings));
}

/// @param code  step of the converter, in the gauge's unit
void append_gauge(const Shot& shot, std::size_t index, std::vector<double> readings,
                  const FirstPulse& pulse, double code, BarRecords& records) {
  const Gauge& gauge = shot.bench.gauges[index];
  const BridgeConversion bridge(gauge, shot.bench.bar_of(gauge), shot.bench.positive);
  std::vector<double> strain(readings.size());
  bridge.convert(readings, quiet_before(readings, records.quiet_samples).baseline, strain);
  const double step = std::abs(bridge.sensitivity() * code);
  records.noise_rms.push_back(
      std::max(quiet_before(strain, records.quiet_samples).noise_rms, step / std::sqrt(12.0)));
  records.rise_s.push_back(pulse.half * records.period_s);
  records.pulls.push_back(pulse.sense * bridge.sensitivity() < 0.0);
  records.position_m.push_back(gauge.position_m);
  const auto rise = static_cast<std::size_t>(pulse.half);
  const std::size_t end = std::min(strain.size(), rise + pulse_reach(1.0 / records.period_s));
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  records.peak.push_back(
      std::abs(*std::max_element(strain.begin() + static_cast<std::ptrdiff_t>(rise),
                                 strain.begin() + static_cast<std::ptrdiff_t>(end), larger)));
  records.step.push_back(step);
  records.strain.push_back(std::move(strain));
}

}  // namespace

std::vector<double> readings_of(const ChannelRecord& channel) {
  std::vector<double> readings(channel.codes.size());
  std::transform(channel.codes.begin(), channel.codes.end(), readings.begin(),
                 [&](std::int32_t code) { return channel.value(code); });
  return readings;
}

BarRecords read_bar_records(const Shot& shot) {
  require_bar(shot);
  BarRecords records;
  records.period_s = shot.rate.period_s();
  records.channel = along_the_bar(shot.bench);
  const double rate_Hz = shot.rate.Hz();
  std::vector<std::vector<double>> readings;
  std::vector<FirstPulse> pulses;
  std::vector<double> codes;
  for (const std::size_t index : records.channel) {
    readings.push_back(readings_of(shot.channels[index]));
    codes.push_back(step_of(shot.channels[index], readings.back()));
    take_out_delay(shot.bench.gauges[index].delay_s, rate_Hz, readings.back());
    pulses.push_back(require_pulse(readings.back(), rate_Hz, shot.bench.gauges[index].name));
  }
  records.quiet_samples = pulses.front().quiet;
  require_quiet(records.quiet_samples);
  records.foot_s = pulses.front().foot * records.period_s;
  for (std::size_t j = 0; j < readings.size(); ++j) {
    append_gauge(shot, records.channel[j], std::move(readings[j]), pulses[j], codes[j], records);
  }
  return records;
}

}  // namespace kolsky

#include "processing/reduction/record_faults.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "processing/bridge/bridge.hpp"
#include "processing/reduction/code_steps.hpp"
#include "processing/reduction/cut_off.hpp"
#include "processing/reduction/first_pulse.hpp"
#include "processing/reduction/pulse.hpp"
#include "processing/reduction/quality.hpp"

namespace kolsky {

namespace {

std::vector<double> readings_of_gauge(const ChannelRecord& channel) {
  std::vector<double> readings(channel.codes.size());
  std::ranges::transform(channel.codes, readings.begin(),
                         [&](std::int32_t code) { return channel.value(code); });
  return readings;
}

std::string cut_off_text(const std::string& gauge, const CutOff& top) {
  return "gauge " + gauge + " stays at its extreme for " + std::to_string(top.count) +
         " samples from " + std::to_string(top.first) + " on: it was cut off there";
}

/// A first pulse as a gauge's record holds it.
struct Seen {
  std::string gauge;
  std::vector<double> readings;
  FirstPulse pulse;
  double strain = 0.0;  ///< of its height, compression positive
};

std::vector<Seen> pulses_of(const Shot& shot) {
  std::vector<Seen> list;
  const std::size_t gauges = std::min(shot.channels.size(), shot.bench.gauges.size());
  for (std::size_t j = 0; j < gauges; ++j) {
    const Gauge& gauge = shot.bench.gauges[j];
    std::vector<double> readings = readings_of_gauge(shot.channels[j]);
    if (const auto pulse = first_pulse(readings, shot.rate.Hz())) {
      const BridgeConversion bridge(gauge, shot.bench.bar_of(gauge), shot.bench.positive);
      const double strain = bridge.strain(pulse->sense * pulse->height);
      list.push_back({gauge.name, std::move(readings), *pulse, strain});
    }
  }
  return list;
}

/// Whether what passes for quiet before a pulse moves by more than a baseline may: more than a
/// fiftieth of the pulse, and far more than its noise and its converter's steps make up.
/// @param longest  of a pulse, in samples
bool moves_before(const Seen& seen, std::size_t longest) {
  constexpr std::size_t kParts = 8;
  constexpr double kOfPulse = 0.02;
  constexpr double kOfNoise = 10.0;
  constexpr double kSteps = 2.0;
  const auto quiet = std::span(seen.readings).first(seen.pulse.quiet);
  // No pulse is quiet for longer than it lasts, and hum moves a longer baseline.
  if (quiet.size() < kFewestQuiet || quiet.size() > longest) {
    return false;
  }
  const std::size_t count = quiet.size() / kParts;
  std::vector<double> means;
  for (std::size_t part = 0; part < kParts; ++part) {
    means.push_back(quiet_before(quiet.subspan(part * count, count), count).baseline);
  }
  const auto [least, most] = std::ranges::minmax(means);
  if (most - least <= kOfPulse * seen.pulse.height) {
    return false;
  }
  double squares = 0.0;
  for (std::size_t n = 1; n < quiet.size(); ++n) {
    squares += std::pow(quiet[n] - quiet[n - 1], 2);
  }
  const double noise = std::sqrt(squares / (2.0 * static_cast<double>(quiet.size() - 1)));
  return most - least > std::max(kOfNoise * noise / std::sqrt(static_cast<double>(count)),
                                 kSteps * least_step(seen.readings));
}

/// The gauge whose record begins within its pulse; empty for none. What it shows first is then the
/// pulse's end, which pulls where other gauges see a push; a drift or hum under a pulse does not
/// turn it round. A faint pulse, as behind a soft specimen, is judged by no baseline.
std::string begins_within_pulse(const Shot& shot) {
  constexpr double kFaint = 0.3;
  std::vector<Seen> pulses = pulses_of(shot);
  double loudest = 0.0;
  for (const Seen& seen : pulses) {
    loudest = std::max(loudest, std::abs(seen.strain));
  }
  std::erase_if(pulses, [&](const Seen& seen) { return std::abs(seen.strain) < kFaint * loudest; });
  const auto pushes = [](const Seen& seen) { return seen.strain > 0.0; };
  if (pulses.size() > 1 && std::ranges::none_of(pulses, pushes)) {
    return {};
  }
  const auto found = std::ranges::find_if(pulses, [&](const Seen& seen) {
    return !pushes(seen) && moves_before(seen, pulse_reach(shot.rate.Hz()));
  });
  return found != pulses.end() ? found->gauge : std::string();
}

}  // namespace

std::string spoiled_because(const Shot& shot) {
  if (std::string unusable = unusable_because(shot); !unusable.empty()) {
    return unusable;
  }
  // A photo-sensor stays at its levels by nature.
  const std::size_t gauges = std::min(shot.channels.size(), shot.bench.gauges.size());
  for (std::size_t j = 0; j < gauges; ++j) {
    if (const auto top = cut_off(readings_of_gauge(shot.channels[j]))) {
      return cut_off_text(shot.channels[j].gauge, *top);
    }
  }
  if (const std::string gauge = begins_within_pulse(shot); !gauge.empty()) {
    return "gauge " + gauge +
           " has no quiet part: its record moves from the first sample on, as where the trigger "
           "came too late";
  }
  return {};
}

std::string too_few_quiet(std::size_t samples) {
  return "too few quiet samples before the pulse: " + std::to_string(samples) + " of at least " +
         std::to_string(kFewestQuiet);
}

}  // namespace kolsky

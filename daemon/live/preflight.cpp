#include "daemon/live/preflight.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "processing/base/error.hpp"
#include "processing/bridge/bridge.hpp"

namespace kolsky {

namespace {

// A shot is in the journal, in its capture and for a moment in a temporary file.
constexpr std::uint64_t kShotsOfRoom = 100;
constexpr std::uint64_t kLeastFree_bytes = 64ull << 20;
constexpr double kBalancedShare =
    0.25;  // of the converter's range that must be free on either side
constexpr std::int64_t kDeadSamples = 50'000;
constexpr double kLoudestShare = 0.05;     // of the range, as rms
constexpr double kLeastFullScale = 20e-6;  // strain; the smallest pulses are ten times this
constexpr double kCoarsestStep = 1e-3;     // strain

PreflightItem connection(const PreflightFacts& facts) {
  if (facts.ended) {
    return {"connection", false, "the replay is over; start the daemon again to replay once more"};
  }
  return {"connection", facts.connected,
          facts.connected ? "the digitiser delivers" : "the digitiser is disconnected"};
}

PreflightItem disk(const PreflightFacts& facts) {
  const std::uint64_t needed = std::max(kLeastFree_bytes, kShotsOfRoom * 3 * facts.shot_bytes);
  return {"disk", facts.disk_free_bytes >= needed,
          fmt::format("{} MiB free in the store, {} MiB needed", facts.disk_free_bytes >> 20,
                      needed >> 20)};
}

PreflightItem ring(const PreflightFacts& facts) {
  const std::size_t needed = 2 * (facts.window_samples + facts.block_samples);
  return {"ring", facts.ring_samples >= needed,
          fmt::format("{} samples, {} needed for the window; ring.seconds sets it",
                      facts.ring_samples, needed)};
}

PreflightItem calibration(const ChannelRecord& channel, const Gauge& gauge, const Shot& blank) {
  const std::string name = "calibration " + channel.gauge;
  try {
    const BridgeConversion conversion(gauge, blank.bench.bar_of(gauge), blank.bench.positive);
    const double per_code = std::abs(conversion.sensitivity() * channel.scale);
    const double range = static_cast<double>(channel.code_max) - channel.code_min;
    const double full_scale = per_code * range;
    const bool ok =
        std::isfinite(full_scale) && full_scale >= kLeastFullScale && per_code <= kCoarsestStep;
    return {name, ok,
            fmt::format("full scale {:.4g} strain, step {:.3g}{}", full_scale, per_code,
                        ok ? "" : ": check gauge factor, gain and scale")};
  } catch (const InputError& error) {
    return {name, false, error.what()};
  }
}

PreflightItem balance(const ChannelRecord& channel, const ChannelCondition& condition) {
  const double range = static_cast<double>(channel.code_max) - channel.code_min;
  const double below = (condition.baseline_codes - channel.code_min) / range;
  const double above = (channel.code_max - condition.baseline_codes) / range;
  const bool ok = std::min(below, above) >= kBalancedShare;
  return {"bridge-balance " + channel.gauge, ok,
          fmt::format("baseline at {:.0f} % of the converter's range{}", 100.0 * below,
                      ok ? "" : ": balance the bridge, a pulse would be clipped")};
}

PreflightItem noise(const ChannelRecord& channel, const ChannelCondition& condition) {
  const std::string name = "noise " + channel.gauge;
  if (!condition.learned) {
    return {name, false, "not known yet: no quiet signal was seen; is the bar at rest?"};
  }
  const double range = static_cast<double>(channel.code_max) - channel.code_min;
  const double rms = condition.noise_codes * std::abs(channel.scale);
  if (condition.constant_samples >= kDeadSamples) {
    return {name, false,
            fmt::format("none at all, the same code for {} samples: the input is dead",
                        condition.constant_samples)};
  }
  const bool ok = condition.noise_codes <= kLoudestShare * range;
  return {name, ok,
          fmt::format("{:.3g} {} rms{}", rms, channel.unit,
                      ok ? "" : ": too loud, check shielding, excitation and gain")};
}

}  // namespace

std::vector<PreflightItem> preflight(const PreflightFacts& facts, const Shot& blank) {
  std::vector<PreflightItem> items{connection(facts), disk(facts), ring(facts)};
  for (std::size_t i = 0; i < blank.channels.size(); ++i) {
    const bool is_gauge = i < blank.bench.gauges.size();
    if (is_gauge) {
      items.push_back(calibration(blank.channels[i], blank.bench.gauges[i], blank));
    }
    if (facts.streaming && is_gauge) {  // light has no bridge to balance and needs no quiet
      items.push_back(balance(blank.channels[i], facts.channels[i]));
      items.push_back(noise(blank.channels[i], facts.channels[i]));
    }
  }
  return items;
}

bool passed(const std::vector<PreflightItem>& items) {
  return std::all_of(items.begin(), items.end(), [](const PreflightItem& item) { return item.ok; });
}

std::string failures(const std::vector<PreflightItem>& items) {
  std::string line;
  for (const PreflightItem& item : items) {
    if (!item.ok) {
      line += fmt::format("{}{}: {}", line.empty() ? "" : "; ", item.name, item.text);
    }
  }
  return line;
}

}  // namespace kolsky

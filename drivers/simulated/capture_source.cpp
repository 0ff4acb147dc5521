#include "drivers/simulated/capture_source.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "drivers/simulated/number_text.hpp"
#include "processing/base/error.hpp"

namespace kolsky {

namespace {

constexpr std::size_t kLeastBaseline = 16;

/// How many samples at the start of a capture come before its pulse.
std::size_t quiet_samples(const Shot& shot) {
  const std::size_t samples = shot.samples();
  std::size_t quiet = samples / 20;
  if (shot.trigger && shot.trigger->tick > shot.first_tick) {
    // The pulse begins before it crosses a trigger's level.
    quiet = static_cast<std::size_t>(shot.trigger->tick - shot.first_tick) * 3 / 4;
  }
  return std::clamp(quiet, std::min(kLeastBaseline, samples), samples);
}

void check_same(const Shot& first, const Shot& other) {
  const auto refuse = [&other](const std::string& what) {
    throw InputError("capture " + other.id, what + " than capture before it",
                     "play captures of one bench and digitiser together");
  };
  if (other.rate != first.rate) {
    refuse("has another rate");
  }
  if (other.channels.size() != first.channels.size()) {
    refuse("has another number of channels");
  }
  for (std::size_t i = 0; i < first.channels.size(); ++i) {
    const ChannelRecord& a = first.channels[i];
    const ChannelRecord& b = other.channels[i];
    if (a.gauge != b.gauge || a.unit != b.unit || a.scale != b.scale || a.offset != b.offset ||
        a.bits != b.bits) {
      refuse("converts gauge '" + b.gauge + "' otherwise");
    }
  }
}

void check_codes(const Shot& shot) {
  if (shot.samples() == 0) {
    throw InputError("capture " + shot.id, "holds no samples", "play another");
  }
  for (const ChannelRecord& channel : shot.channels) {
    const auto [least, most] = std::minmax_element(channel.codes.begin(), channel.codes.end());
    const double limit = std::ldexp(1.0, channel.bits - 1);
    if (channel.bits < 12 || channel.bits > 32 || *least < -limit || *most >= limit) {
      throw InputError("capture " + shot.id + ": gauge '" + channel.gauge + "'",
                       "holds codes that a converter of " + std::to_string(channel.bits) +
                           " bits (12 to 32) does not give",
                       "play another");
    }
  }
}

}  // namespace

CaptureSource::CaptureSource(std::vector<Shot> captures, std::uint64_t seed)
    : captures_(std::move(captures)), seed_(seed) {
  if (captures_.empty()) {
    throw InputError("captures", "none to play", "give at least one");
  }
  for (const Shot& shot : captures_) {
    check_codes(shot);
    check_same(captures_.front(), shot);
    longest_ = std::max(longest_, static_cast<Tick>(shot.samples()));
    std::vector<Baseline>& baselines = baselines_.emplace_back();
    for (const ChannelRecord& channel : shot.channels) {
      const std::span<const std::int32_t> quiet(channel.codes.data(), quiet_samples(shot));
      const auto count = static_cast<double>(quiet.size());
      Baseline baseline;
      baseline.mean = std::accumulate(quiet.begin(), quiet.end(), 0.0) / count;
      for (const std::int32_t code : quiet) {
        baseline.rms += (code - baseline.mean) * (code - baseline.mean);
      }
      baseline.rms = std::sqrt(baseline.rms / count);
      baselines.push_back(baseline);
    }
  }
  for (std::size_t i = 0; i < captures_.front().channels.size(); ++i) {
    noise_.emplace_back(seed_, i);
  }
}

void CaptureSource::convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) {
  const Baseline& idle = baselines_.front()[channel];
  values_.assign(codes.size(), idle.mean);
  noise_[channel].add(first_tick, idle.rms, values_);
  const Tick end = first_tick + static_cast<Tick>(codes.size());
  schedule_.overlapping(first_tick, end, shot_samples(), [&](const ShotSchedule::Fired& shot) {
    const std::size_t capture = shot.number % captures_.size();
    play(captures_[capture].channels[channel], idle, shot.tick, first_tick, values_);
  });
  const double limit = std::ldexp(1.0, captures_.front().channels[channel].bits - 1);
  for (std::size_t i = 0; i < codes.size(); ++i) {
    codes[i] =
        static_cast<std::int32_t>(std::clamp(std::nearbyint(values_[i]), -limit, limit - 1.0));
  }
}

void CaptureSource::play(const ChannelRecord& record, const Baseline& baseline, Tick shot_tick,
                         Tick first_tick, std::span<double> values) const {
  const auto samples = static_cast<Tick>(record.codes.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Tick at = first_tick + static_cast<Tick>(i) - shot_tick;
    if (at < 0 || at >= 2 * samples) {
      continue;
    }
    if (at < samples) {
      values[i] = record.codes[static_cast<std::size_t>(at)];
      continue;
    }
    const double c = std::cos(std::numbers::pi / 2.0 * static_cast<double>(at - samples) /
                              static_cast<double>(samples));
    values[i] += (record.codes.back() - baseline.mean) * c * c;
  }
}

AdcSettings CaptureSource::settings() const {
  const Shot& shot = captures_.front();
  AdcSettings settings;
  settings.bits = 12;
  settings.rate = shot.rate;
  settings.rates = {shot.rate};
  settings.seed = seed_;
  settings.scenario = "capture " + shot.id;
  for (std::size_t i = 0; i < shot.channels.size(); ++i) {
    const ChannelRecord& record = shot.channels[i];
    settings.bits = std::max(settings.bits, record.bits);
    AdcChannel channel;
    channel.label = record.gauge;
    channel.scale_mV = record.scale * 1e3;
    channel.offset_codes = record.offset;
    if (record.unit == "strain") {
      channel.strain_scale = record.scale;
    } else if (i < shot.bench.gauges.size() && shot.bench.gauges[i].strain_per_V) {
      channel.strain_scale = record.scale * *shot.bench.gauges[i].strain_per_V;
    }
    settings.channels.push_back(channel);
  }
  return settings;
}

}  // namespace kolsky

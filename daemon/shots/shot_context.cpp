#include "daemon/shots/shot_context.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "processing/base/error.hpp"
#include "processing/base/material.hpp"

namespace kolsky {

namespace {

double wave_speed_m_per_s(const Bar& bar, const std::optional<Material>& model) {
  const double modulus_Pa = bar.youngs_modulus_Pa ? bar.youngs_modulus_Pa->value
                                                  : model.value_or(paper_pmma()).E1_Pa().value;
  return std::sqrt(modulus_Pa / bar.density_kg_m3);
}

struct RehearsalPulse {
  double start_samples;
  double duration_samples;
  double height_codes;

  [[nodiscard]] double at(double sample) const {
    const double phase = (sample - start_samples) / duration_samples;
    return phase > 0.0 && phase < 1.0 ? height_codes * std::sin(std::numbers::pi * phase) : 0.0;
  }
};

}  // namespace

Shot blank_shot(const DaemonConfig& config, const Apparatus& apparatus, const StreamInfo& stream) {
  const std::vector<BenchChannel> gauges = apparatus.bench.channels();
  const bool gauges_only = apparatus.bench.photo_sensors.empty();
  if (stream.channels.size() != gauges.size()) {
    throw InputError(config.file.string() + ": digitiser",
                     fmt::format("{} delivers {} channels, {} has {} {}", stream.uri,
                                 stream.channels.size(), config.bench.string(), gauges.size(),
                                 gauges_only ? "gauges" : "gauges and photo-sensors"),
                     "name one channel for each gauge in digitiser.channels");
  }
  Shot blank;
  blank.bench = apparatus.bench;
  blank.bench_toml = apparatus.bench_toml;
  blank.bar_model = apparatus.bar_model;
  blank.reduction = config.reduction;
  blank.rate = stream.rate;
  blank.meta = config.meta;
  blank.software_version = KOLSKY_VERSION;
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    const ChannelInfo& channel = stream.channels[i];
    if (channel.unit != gauges[i].unit) {
      throw InputError(
          fmt::format("{}: gauges[{}].unit", config.bench.string(), i),
          fmt::format("gauge {} is in {}, channel {} of {} delivers {}", gauges[i].name,
                      gauges[i].unit, channel.name, stream.uri, channel.unit),
          fmt::format("give unit = \"{}\" and what converts it to strain", channel.unit));
    }
    ChannelRecord record;
    record.gauge = gauges[i].name;
    record.unit = channel.unit;
    record.scale = channel.scale;
    record.offset = channel.offset;
    record.bits = channel.bits;
    record.code_min = channel.code_min;
    record.code_max = channel.code_max;
    blank.channels.push_back(std::move(record));
  }
  return blank;
}

SampleRing::CopyStatus cut_window(const SampleRing& ring, const Window& window, Shot& shot) {
  const auto samples = static_cast<std::size_t>(window.end_tick - window.first_tick);
  shot.first_tick = window.first_tick;
  shot.trigger = window.trigger;
  for (std::size_t i = 0; i < shot.channels.size(); ++i) {
    shot.channels[i].codes.resize(samples);
    const SampleRing::CopyStatus status = ring.copy(i, window.first_tick, shot.channels[i].codes);
    if (status != SampleRing::CopyStatus::copied) {
      return status;
    }
  }
  return SampleRing::CopyStatus::copied;
}

const PlayedCapture* capture_at(const std::vector<PlayedCapture>& captures, Tick tick) {
  const auto after = std::upper_bound(
      captures.begin(), captures.end(), tick,
      [](Tick wanted, const PlayedCapture& capture) { return wanted < capture.first_tick; });
  return after == captures.begin() ? nullptr : &*std::prev(after);
}

void file_facts_of(const PlayedCapture& capture, Shot& shot) {
  for (const auto& [key, value] : capture.meta) {
    shot.meta[key] = value;
  }
  shot.meta["replayed_from"] = capture.id;
}

void mark_interrupted(Shot& shot) {
  const Tick end_tick = shot.first_tick + static_cast<Tick>(shot.samples());
  for (ChannelRecord& channel : shot.channels) {
    channel.codes.push_back(channel.codes.back());
  }
  shot.gaps.push_back({.first_tick = end_tick, .samples = 0, .known = false});
}

Shot rehearsal_shot(const Shot& blank, std::int64_t pre_samples, std::int64_t post_samples) {
  constexpr double kPulse_s = 170e-6;
  Shot shot = blank;
  const double rate_Hz = shot.rate.Hz();
  const auto start = static_cast<double>(pre_samples);
  const double duration = std::min(kPulse_s * rate_Hz, 0.2 * static_cast<double>(post_samples));
  const Bar& input = shot.bench.input;
  const double speed = wave_speed_m_per_s(input, shot.bar_model);
  shot.trigger = TriggerEvent{.tick = pre_samples, .fraction = 0.5, .sigma_samples = 0.1};
  for (std::size_t i = 0; i < shot.channels.size(); ++i) {
    ChannelRecord& channel = shot.channels[i];
    channel.codes.assign(static_cast<std::size_t>(pre_samples + post_samples), channel.code_max);
    if (i >= shot.bench.gauges.size()) {
      continue;  // a photo-sensor that nothing passes
    }
    const Gauge& gauge = shot.bench.gauges[i];
    const double to_specimen_samples = shot.bench.distance_to_specimen_m(gauge) / speed * rate_Hz;
    const double range = static_cast<double>(channel.code_max) - channel.code_min;
    const double middle = static_cast<double>(channel.code_min) + 0.5 * range;
    const bool input_side = gauge.bar != "output";
    const RehearsalPulse first{input_side ? start : start + 2.0 * to_specimen_samples, duration,
                               (input_side ? 0.3 : 0.1) * range};
    const RehearsalPulse second{start + 2.0 * to_specimen_samples, duration,
                                input_side ? -0.2 * range : 0.0};
    for (std::size_t k = 0; k < channel.codes.size(); ++k) {
      const auto sample = static_cast<double>(k);
      // A least-bit ripple: a record without noise is not like those to come.
      const double value = middle + first.at(sample) + second.at(sample) + (k % 2 == 0 ? 1.0 : 0.0);
      channel.codes[k] = static_cast<std::int32_t>(std::lround(value));
    }
  }
  return shot;
}

}  // namespace kolsky

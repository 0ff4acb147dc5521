#include "drivers/replay/replay_source.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "drivers/files/captures/capture.hpp"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

/// As for an imported table: its time column, not the bench, gives a capture's rate.
constexpr double kRateTolerance = 0.01;

ChannelInfo stream_channel(const ChannelRecord& record) {
  return {.name = record.gauge,
          .unit = record.unit,
          .scale = record.scale,
          .offset = record.offset,
          .bits = record.bits,
          .code_min = record.code_min,
          .code_max = record.code_max};
}

std::string channel_names(const Shot& shot) {
  std::string names;
  for (const ChannelRecord& channel : shot.channels) {
    names += (names.empty() ? "" : ", ") + channel.gauge;
  }
  return names;
}

/// Those of these names in their order; none of a name that is not there.
std::vector<ChannelRecord> named_channels(const Shot& shot, const std::vector<std::string>& names) {
  std::vector<ChannelRecord> found;
  for (const std::string& name : names) {
    std::copy_if(shot.channels.begin(), shot.channels.end(), std::back_inserter(found),
                 [&](const ChannelRecord& record) { return record.gauge == name; });
  }
  return found;
}

std::vector<ChannelRecord> chosen_channels(const Shot& shot, const DigitiserOptions& options,
                                           const std::string& place) {
  if (options.channels.empty()) {
    const std::size_t count =
        options.channel_count == 0 ? shot.channels.size() : options.channel_count;
    if (shot.channels.size() < count) {
      throw InputError(place,
                       "has " + std::to_string(shot.channels.size()) + " channels (" +
                           channel_names(shot) + "), the bench has " + std::to_string(count) +
                           " gauges",
                       "replay it with the bench it was taken with");
    }
    std::vector<ChannelRecord> named = named_channels(shot, options.gauges);
    if (named.empty()) {
      return {shot.channels.begin(), shot.channels.begin() + static_cast<std::ptrdiff_t>(count)};
    }
    if (named.size() != count) {
      throw InputError(place,
                       "has the channels " + channel_names(shot) +
                           ", of which only some are gauges of the bench",
                       "name those to take in digitiser.channels, in the gauges' order");
    }
    return named;
  }
  std::vector<ChannelRecord> chosen;
  for (const std::string& name : options.channels) {
    const auto found =
        std::find_if(shot.channels.begin(), shot.channels.end(),
                     [&](const ChannelRecord& record) { return record.gauge == name; });
    if (found == shot.channels.end()) {
      throw InputError(place, "has no channel " + name, "choose from " + channel_names(shot));
    }
    chosen.push_back(*found);
  }
  return chosen;
}

void check_units(const std::vector<ChannelRecord>& channels, const DigitiserOptions& options,
                 const std::string& place) {
  for (std::size_t i = 0; i < std::min(channels.size(), options.units.size()); ++i) {
    if (channels[i].unit != options.units[i]) {
      throw InputError(place + ": channel " + channels[i].gauge,
                       "is in " + channels[i].unit + ", the gauge's unit is " + options.units[i],
                       "replay it with the bench it was taken with");
    }
  }
}

void check_rate(const Shot& shot, double asked_Hz, const std::string& place) {
  if (asked_Hz > 0.0 && std::abs(shot.rate.Hz() - asked_Hz) > kRateTolerance * asked_Hz) {
    throw InputError(place,
                     "was sampled at " + std::to_string(shot.rate.Hz()) + " Hz, the bench says " +
                         std::to_string(asked_Hz) + " Hz",
                     "replay it with the bench it was taken with");
  }
}

void check_times(const Shot& shot, const std::string& place) {
  const Tick end = shot.first_tick + static_cast<Tick>(shot.samples());
  const auto inside = [&](Tick tick) { return tick >= shot.first_tick && tick < end; };
  if (shot.samples() == 0) {
    throw InputError(place, "holds no samples", "take it out of the replay");
  }
  if (shot.trigger && !inside(shot.trigger->tick)) {
    throw InputError(place, "its trigger is outside its samples", "take it out of the replay");
  }
  for (const Gap& gap : shot.gaps) {
    if (!inside(gap.first_tick) || gap.samples < 0 || gap.samples > end - gap.first_tick) {
      throw InputError(place, "one of its gaps is outside its samples",
                       "take it out of the replay");
    }
  }
}

/// What the capture has in another way than the first one; empty if it delivers the same stream.
std::string difference(const Shot& shot, SampleRate rate,
                       const std::vector<ChannelInfo>& channels) {
  if (!(shot.rate == rate)) {
    return "rate";
  }
  if (shot.channels.size() != channels.size()) {
    return "number of channels";
  }
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const ChannelInfo info = stream_channel(shot.channels[i]);
    if (info.name != channels[i].name) {
      return "channels";
    }
    if (info.unit != channels[i].unit || info.scale != channels[i].scale ||
        info.offset != channels[i].offset) {
      return "scale of channel " + info.name;
    }
    if (info.bits != channels[i].bits || info.code_min != channels[i].code_min ||
        info.code_max != channels[i].code_max) {
      return "converter of channel " + info.name;
    }
  }
  return {};
}

}  // namespace

ReplaySource::ReplaySource(const std::filesystem::path& path, const DigitiserOptions& options)
    : paths_(captures_in(path)), options_(options) {
  for (const std::filesystem::path& capture : paths_) {
    const Shot shot = chosen(read_capture(capture), capture);
    captures_.push_back({.id = shot.id,
                         .first_tick = static_cast<Tick>(total_samples_),
                         .samples = shot.samples(),
                         .meta = shot.meta,
                         .bench_toml = shot.bench_toml});
    total_samples_ += shot.samples();
    if (channels_.empty()) {
      rate_ = shot.rate;
      std::transform(shot.channels.begin(), shot.channels.end(), std::back_inserter(channels_),
                     stream_channel);
    }
    const std::string odd = difference(shot, rate_, channels_);
    if (!odd.empty()) {
      throw InputError(capture.string(),
                       "its " + odd + " differs from that of " + paths_.front().string(),
                       "replay it on its own");
    }
  }
}

Shot ReplaySource::chosen(Shot shot, const std::filesystem::path& path) const {
  const std::string place = path.string();
  shot.channels = chosen_channels(shot, options_, place);
  check_units(shot.channels, options_, place);
  check_rate(shot, options_.sampling_frequency_Hz, place);
  check_times(shot, place);
  std::sort(shot.gaps.begin(), shot.gaps.end(),
            [](const Gap& a, const Gap& b) { return a.first_tick < b.first_tick; });
  return shot;
}

Shot ReplaySource::load(std::size_t index) const {
  const std::filesystem::path& path = paths_[index];
  Shot shot = chosen(read_capture(path), path);
  const std::string odd = difference(shot, rate_, channels_);
  if (!odd.empty()) {
    throw InputError(path.string(), "its " + odd + " has changed since the replay began",
                     "begin anew");
  }
  return shot;
}

}  // namespace kolsky

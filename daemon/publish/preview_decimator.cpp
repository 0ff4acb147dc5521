#include "daemon/publish/preview_decimator.hpp"

#include <algorithm>

#include "kolsky/v1/kolsky.pb.h"
#include "proto/waveform.hpp"

namespace kolsky {
namespace {

/// @param channel  its codes are replaced
void pack(ChannelRecord& channel, std::span<const std::int32_t> codes, double step_s,
          v1::Waveform& waveform) {
  channel.codes.assign(codes.begin(), codes.end());
  wire::pack_codes(channel, waveform);
  waveform.set_step_s(step_s);
}

}  // namespace

PreviewDecimator::PreviewDecimator(std::vector<ChannelRecord> channels, SampleRate rate,
                                   std::size_t samples_per_step, std::size_t steps_per_message)
    : channels_(std::move(channels)),
      rate_(rate),
      samples_per_step_(std::max<std::size_t>(samples_per_step, 1)),
      steps_per_message_(std::max<std::size_t>(steps_per_message, 1)),
      minimum_(channels_.size() * steps_per_message_),
      maximum_(channels_.size() * steps_per_message_) {}

void PreviewDecimator::begin(Tick first_tick) noexcept {
  if (started_) {
    const Tick expected = first_tick_ + static_cast<Tick>(samples_);
    missing_ += static_cast<std::uint64_t>(std::max<Tick>(first_tick - expected, 0));
  }
  first_tick_ = first_tick;
  samples_ = 0;
  started_ = true;
}

void PreviewDecimator::add(std::size_t channel, std::span<const std::int32_t> codes) noexcept {
  std::int32_t* minimum = minimum_.data() + channel * steps_per_message_;
  std::int32_t* maximum = maximum_.data() + channel * steps_per_message_;
  std::size_t sample = samples_;
  while (!codes.empty()) {
    const std::size_t step = sample / samples_per_step_;
    const std::size_t within = sample % samples_per_step_;
    const std::size_t count = std::min(codes.size(), samples_per_step_ - within);
    const auto [low, high] = std::ranges::minmax(codes.first(count));
    minimum[step] = within == 0 ? low : std::min(minimum[step], low);
    maximum[step] = within == 0 ? high : std::max(maximum[step], high);
    codes = codes.subspan(count);
    sample += count;
  }
}

std::size_t PreviewDecimator::feed(Tick first_tick,
                                   std::span<const std::span<const std::int32_t>> codes) noexcept {
  if (complete_ || codes.empty() || codes.front().empty()) {
    return 0;
  }
  if (!started_ || first_tick != first_tick_ + static_cast<Tick>(samples_)) {
    if (samples_ > 0) {
      complete_ = true;
      return 0;
    }
    begin(first_tick);
  }
  const std::size_t room = samples_per_step_ * steps_per_message_ - samples_;
  const std::size_t taken = std::min(codes.front().size(), room);
  for (std::size_t channel = 0; channel < channels_.size(); ++channel) {
    add(channel, codes[channel].first(taken));
  }
  samples_ += taken;
  complete_ = taken == room;
  return taken;
}

void PreviewDecimator::take(v1::Preview& preview) {
  const std::size_t steps = (samples_ + samples_per_step_ - 1) / samples_per_step_;
  const double step_s = static_cast<double>(samples_per_step_) * rate_.period_s();
  preview.Clear();
  preview.mutable_first()->set_tick(first_tick_);
  preview.mutable_first()->set_rate_numerator(rate_.numerator);
  preview.mutable_first()->set_rate_denominator(rate_.denominator);
  preview.set_step_s(step_s);
  preview.set_missing_samples(missing_);
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    v1::ChannelPreview& channel = *preview.add_channels();
    channel.set_gauge(channels_[i].gauge);
    const std::size_t first = i * steps_per_message_;
    pack(channels_[i], std::span(minimum_).subspan(first, steps), step_s,
         *channel.mutable_minimum());
    pack(channels_[i], std::span(maximum_).subspan(first, steps), step_s,
         *channel.mutable_maximum());
  }
  first_tick_ += static_cast<Tick>(samples_);
  samples_ = 0;
  missing_ = 0;
  complete_ = false;
}

}  // namespace kolsky

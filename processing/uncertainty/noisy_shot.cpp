#include "processing/uncertainty/noisy_shot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace kolsky {

namespace {

/// How far a channel's codes can be divided, at most 64 times, with room for noise.
std::int32_t division(const ChannelRecord& channel) {
  std::int64_t most = 1;
  for (const std::int32_t code : channel.codes) {
    most = std::max(most, std::abs(static_cast<std::int64_t>(code)));
  }
  std::int32_t parts = 64;
  while (parts > 1 && most * parts > std::numeric_limits<std::int32_t>::max() / 2) {
    parts /= 2;
  }
  return parts;
}

Shot finer(const Shot& shot) {
  Shot fine = shot;
  for (ChannelRecord& channel : fine.channels) {
    const std::int32_t parts = division(channel);
    channel.scale /= parts;
    channel.offset *= parts;
    channel.code_min = std::numeric_limits<std::int32_t>::min();
    channel.code_max = std::numeric_limits<std::int32_t>::max();
    for (std::int32_t& code : channel.codes) {
      code *= parts;
    }
  }
  return fine;
}

}  // namespace

NoisyShot::NoisyShot(const Shot& shot, std::size_t quiet_samples)
    : shot_(finer(shot)), as_recorded_(shot_.channels), noise_(shot.samples()) {
  for (const ChannelRecord& channel : as_recorded_) {
    const std::vector<double> quiet(
        channel.codes.begin(), channel.codes.begin() + static_cast<std::ptrdiff_t>(quiet_samples));
    makers_.emplace_back(quiet, shot.samples());
    steps_.emplace_back(channel.codes, quiet_samples);
  }
}

bool NoisyShot::has_steps() const {
  return std::ranges::any_of(steps_, [](const ConverterSteps& own) { return own.matters(); });
}

void NoisyShot::record(RandomStream* noise, RandomStream* steps) {
  for (std::size_t c = 0; c < as_recorded_.size(); ++c) {
    auto& codes = shot_.channels[c].codes;
    const bool stepped = steps != nullptr && steps_[c].matters();
    if (noise == nullptr && !stepped) {
      codes = as_recorded_[c].codes;
      continue;
    }
    std::ranges::fill(noise_, 0.0);
    if (noise != nullptr) {
      makers_[c].make(*noise, noise_);
    }
    if (stepped) {
      steps_[c].add(*steps, noise_);
    }
    for (std::size_t n = 0; n < codes.size(); ++n) {
      codes[n] = as_recorded_[c].codes[n] + static_cast<std::int32_t>(std::lrint(noise_[n]));
    }
  }
}

}  // namespace kolsky

#include "daemon/live/previewer.hpp"

#include <algorithm>
#include <cmath>

#include "kolsky/v1/kolsky.pb.h"

namespace kolsky {

namespace {

constexpr double kSteps_per_s = 4000.0;
constexpr std::size_t kStepsPerMessage = 200;
constexpr std::size_t kChunk = 8192;
constexpr Tick kMostPerLook = 1 << 19;

std::size_t samples_per_step(const SampleRate& rate) {
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(rate.Hz() / kSteps_per_s)));
}

}  // namespace

Previewer::Previewer(const SampleRing& ring, Publisher& publisher, const Shot& blank)
    : ring_(ring),
      publisher_(publisher),
      decimator_(blank.channels, blank.rate, samples_per_step(blank.rate), kStepsPerMessage),
      chunk_(blank.channels.size(), std::vector<std::int32_t>(kChunk)),
      codes_(blank.channels.size()) {}

void Previewer::publish_new() {
  const Tick end = ring_.end_tick();
  if (!started_) {
    next_tick_ = end;
    started_ = true;
  }
  next_tick_ = std::max(next_tick_, end - kMostPerLook);
  while (next_tick_ < end) {
    const auto samples = std::min(kChunk, static_cast<std::size_t>(end - next_tick_));
    if (!copy(next_tick_, samples)) {
      next_tick_ = end;
      return;
    }
    const std::size_t taken = decimator_.feed(next_tick_, codes_);
    next_tick_ += static_cast<Tick>(taken);
    if (decimator_.complete()) {
      v1::Preview preview;
      decimator_.take(preview);
      publisher_.publish_preview(preview);
    }
  }
}

bool Previewer::copy(Tick first, std::size_t samples) {
  for (std::size_t i = 0; i < chunk_.size(); ++i) {
    const std::span<std::int32_t> codes(chunk_[i].data(), samples);
    if (ring_.copy(i, first, codes) != SampleRing::CopyStatus::copied) {
      return false;
    }
    codes_[i] = codes;
  }
  return true;
}

}  // namespace kolsky

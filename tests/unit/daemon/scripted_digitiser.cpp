#include "tests/unit/daemon/scripted_digitiser.hpp"

#include <chrono>
#include <thread>

#include "tests/unit/daemon/thread_conduct.hpp"

namespace kolsky {

ScriptedDigitiser::ScriptedDigitiser() : codes_(kChannels, std::vector<std::int16_t>(kBlock)) {
  info_.uri = "scripted:";
  info_.rate = {1'000'000, 1};
  info_.channels = {{.name = "voltage0", .unit = "strain", .scale = 1e-7},
                    {.name = "voltage1", .unit = "strain", .scale = 1e-7}};
  info_.max_block_samples = kBlock;
}

void ScriptedDigitiser::deliver(std::size_t samples) {
  while (samples > 0) {
    const std::size_t now = std::min(samples, kBlock);
    steps_.push_back({.samples = now});
    samples -= now;
  }
}

std::int16_t ScriptedDigitiser::code(std::size_t channel, Tick tick) const {
  // Irwin-Hall noise of 4 codes rms, a fixed one for each tick.
  auto state = static_cast<std::uint64_t>(tick) * 0x9E3779B97F4A7C15ULL + channel;
  double noise = -6.0;
  for (int i = 0; i < 12; ++i) {
    state ^= state >> 31U;
    state *= 0xBF58476D1CE4E5B9ULL;
    state ^= state >> 27U;
    noise += static_cast<double>(state >> 11U) * 0x1p-53;
  }
  double value = 100.0 + 4.0 * noise;
  for (const Tick pulse : pulses_) {
    const auto age = static_cast<double>(tick - pulse);
    if (age >= 0.0 && age < 150.0) {
      value += 3000.0 * std::min(1.0, age / 20.0);
    }
  }
  return static_cast<std::int16_t>(value);
}

ReadStatus ScriptedDigitiser::read(Block& block) {
  watch_conduct(next_ > 0);
  if (cancelled_.load()) {
    return ReadStatus::disconnected;
  }
  if (next_ == steps_.size()) {
    done_.store(true);
    if (info_.ends) {
      return ReadStatus::end_of_capture;
    }
    if (const std::size_t live = std::min(live_.load(), kBlock); live > 0) {
      live_.fetch_sub(live);
      return give({.samples = live}, block);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return ReadStatus::timeout;
  }
  return give(steps_[next_++], block);
}

ReadStatus ScriptedDigitiser::give(const Step& step, Block& block) {
  if (step.status != ReadStatus::samples) {
    return step.status;
  }
  tick_ += step.missing.samples;
  block.first_tick = tick_;
  block.samples = step.samples;
  block.missing_before = step.missing;
  block.monotonic_ns = tick_ * 1000;
  block.mark = step.mark;
  block.starts_capture = step.starts_capture;
  block.channels.resize(kChannels);
  for (std::size_t i = 0; i < kChannels; ++i) {
    for (std::size_t k = 0; k < step.samples; ++k) {
      codes_[i][k] = code(i, tick_ + static_cast<Tick>(k));
    }
    block.channels[i] = std::as_bytes(std::span(codes_[i]).first(step.samples));
  }
  tick_ += static_cast<Tick>(step.samples);
  return ReadStatus::samples;
}

bool ScriptedDigitiser::reconnect() {
  if (refusals_ > 0) {
    --refusals_;
    return false;
  }
  if (rescale_) {
    info_.channels[0].scale *= 2.0;
  }
  return true;
}

}  // namespace kolsky

#include "daemon/acquisition/level_board.hpp"

namespace kolsky {

void LevelBoard::forget() noexcept {
  for (Shown& shown : shown_) {
    shown.learned.store(false, std::memory_order_relaxed);
  }
  for (ChannelLevel& channel : quiet_) {
    channel.forget();
  }
}

void LevelBoard::follow(std::span<const RunStatistics> statistics, std::size_t trigger_channel,
                        const IncidentTrigger& trigger) noexcept {
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    if (i == trigger_channel) {
      show(trigger, shown_[i]);
    } else {
      quiet_[i].take(statistics[i]);
      show(quiet_[i], shown_[i]);
    }
    follow_constant(statistics[i], shown_[i]);
  }
}

SignalLevel LevelBoard::level(std::size_t channel) const noexcept {
  const Shown& shown = shown_[channel];
  return {.baseline_codes = shown.baseline.load(std::memory_order_relaxed),
          .noise_codes = shown.noise.load(std::memory_order_relaxed),
          .level_codes = shown.level.load(std::memory_order_relaxed),
          .constant_samples = shown.constant.load(std::memory_order_relaxed),
          .learned = shown.learned.load(std::memory_order_relaxed)};
}

void LevelBoard::show(const IncidentTrigger& trigger, Shown& shown) noexcept {
  shown.baseline.store(trigger.baseline_codes(), std::memory_order_relaxed);
  shown.noise.store(trigger.noise_codes(), std::memory_order_relaxed);
  shown.level.store(trigger.level_codes(), std::memory_order_relaxed);
  if (trigger.ready()) {  // stays so: in the hold-off after a trigger they are still known
    shown.learned.store(true, std::memory_order_relaxed);
  }
}

void LevelBoard::show(const ChannelLevel& quiet, Shown& shown) noexcept {
  shown.baseline.store(quiet.baseline_codes(), std::memory_order_relaxed);
  shown.noise.store(quiet.noise_codes(), std::memory_order_relaxed);
  shown.level.store(0.0, std::memory_order_relaxed);
  shown.learned.store(quiet.learned(), std::memory_order_relaxed);
}

void LevelBoard::follow_constant(const RunStatistics& run, Shown& shown) noexcept {
  const bool same = run.minimum == run.maximum && run.minimum == shown.last_code;
  shown.last_code = run.maximum;
  const std::int64_t before = same ? shown.constant.load(std::memory_order_relaxed) : 0;
  shown.constant.store(before + (same ? run.count : 0), std::memory_order_relaxed);
}

}  // namespace kolsky

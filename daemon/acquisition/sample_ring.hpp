#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "drivers/digitiser/digitiser.hpp"
#include "processing/trigger/incident_trigger.hpp"

namespace kolsky {

/// The last so many samples of every channel, planar, in memory that is allocated and touched at
/// construction. One thread writes, never waits and never fails; any thread may copy a window out and is
/// told when it came too late. Ticks index it, so a known hole takes its place (the last code repeated).
class SampleRing {
 public:
  /// @param capacity_samples  per channel; rounded up to a power of two
  SampleRing(SampleFormat format, std::size_t channels, std::size_t capacity_samples);

  /// Writer only: appends a block, taking statistics of each channel on the way.
  /// @param statistics  one per channel
  void write(const Block& block, std::span<RunStatistics> statistics) noexcept;

  enum class CopyStatus { copied, not_yet, overwritten };

  /// Copies [first, first + codes.size()) of one channel. Any thread.
  [[nodiscard]] CopyStatus copy(std::size_t channel, Tick first, std::span<std::int32_t> codes) const noexcept;

  /// Tick after the newest sample.
  [[nodiscard]] Tick end_tick() const noexcept;
  /// Waits until end_tick() > tick or `stop_waiting` is called.
  void wait_past(Tick tick) const noexcept;
  void stop_waiting() noexcept;

  [[nodiscard]] std::size_t capacity_samples() const noexcept { return capacity_; }
  [[nodiscard]] std::size_t channels() const noexcept { return channels_; }
  [[nodiscard]] SampleFormat format() const noexcept { return format_; }

 private:
  SampleFormat format_;
  std::size_t channels_;
  std::size_t capacity_;
  std::vector<std::byte> memory_;
};

}  // namespace kolsky

#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "drivers/digitiser/digitiser.hpp"
#include "processing/trigger/run_statistics.hpp"

namespace kolsky {

/// The last so many samples of every channel, planar, in memory that is allocated and touched at
/// construction. One thread writes, never waits and never fails; any thread may copy a window out
/// and is told when it came too late. Ticks index it, so a known hole takes its place (the last
/// code repeated).
class SampleRing {
 public:
  /// @param capacity_samples  per channel; rounded up to a power of two
  /// @throws InputError where a number is zero or the memory is not to be had
  SampleRing(SampleFormat format, std::size_t channels, std::size_t capacity_samples);

  /// Writer only: appends a block, taking statistics of each channel on the way. The first block
  /// sets where the ring begins. Samples whose ticks have been written before are left out. A hole
  /// costs no more than filling the ring once, however long it is.
  /// @param statistics  one per channel, of the block's own samples
  void write(const Block& block, std::span<RunStatistics> statistics) noexcept;

  enum class CopyStatus {
    copied,
    not_yet,      ///< some of the window has still to come
    overwritten,  ///< some of it is gone, or was before the ring began; the codes are not to be
                  ///< used
  };

  /// Copies [first, first + codes.size()) of one channel. Any thread.
  [[nodiscard]] CopyStatus copy(std::size_t channel, Tick first,
                                std::span<std::int32_t> codes) const noexcept;

  /// Tick after the newest sample.
  [[nodiscard]] Tick end_tick() const noexcept;

  [[nodiscard]] std::size_t capacity_samples() const noexcept { return capacity_; }
  [[nodiscard]] std::size_t channels() const noexcept { return channels_; }
  [[nodiscard]] SampleFormat format() const noexcept { return format_; }

 private:
  struct Free {
    void operator()(std::byte* memory) const noexcept;
  };
  template <class Code>
  [[nodiscard]] std::span<Code> plane(std::size_t channel) const noexcept;
  template <class Code>
  void write_channel(std::size_t channel, const Block& block, Tick end,
                     RunStatistics& statistics) noexcept;
  template <class Code>
  void copy_out(std::size_t channel, Tick first, std::span<std::int32_t> codes) const noexcept;
  void claim(Tick end) noexcept;
  void publish(Tick end) noexcept;

  SampleFormat format_;
  std::size_t channels_;
  std::size_t capacity_;
  std::size_t stride_bytes_;  ///< from one channel's plane to the next
  std::unique_ptr<std::byte, Free> memory_;

  // A sequence lock by ticks. The writer claims the ticks it is about to write, writes, then
  // publishes them; what a reader copied is good if nothing within a capacity of it was claimed
  // meanwhile.
  static constexpr std::size_t kCacheLine = 64;
  alignas(kCacheLine) std::atomic<Tick> claimed_{0};
  alignas(kCacheLine) std::atomic<Tick> published_{0};
  std::atomic<Tick> begin_{0};  ///< the first tick ever written
  bool empty_ = true;           ///< writer only
};

}  // namespace kolsky

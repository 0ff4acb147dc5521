#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "processing/base/shot.hpp"
#include "proto/forward.hpp"

namespace kolsky {

/// Reduces what streams in to one minimum and one maximum per step and channel. Pure; `feed`
/// allocates nothing. Ticks may jump: the message under way is then cut short and the samples
/// between are counted.
class PreviewDecimator {
 public:
  /// @param channels  what the codes mean; their own codes are not looked at
  /// @param samples_per_step, steps_per_message  at least 1 each
  PreviewDecimator(std::vector<ChannelRecord> channels, SampleRate rate,
                   std::size_t samples_per_step, std::size_t steps_per_message);

  /// Takes samples until a message is complete. @param codes  one span per channel, all equally
  /// long
  /// @return how many it took; after `take`, feed the rest, from the tick where it stopped
  [[nodiscard]] std::size_t feed(Tick first_tick,
                                 std::span<const std::span<const std::int32_t>> codes) noexcept;
  /// Whether a message waits to be taken.
  [[nodiscard]] bool complete() const noexcept { return complete_; }
  /// Moves the message out and goes on behind it. The last pair of one cut short covers fewer
  /// samples.
  void take(v1::Preview& preview);

 private:
  void begin(Tick first_tick) noexcept;
  void add(std::size_t channel, std::span<const std::int32_t> codes) noexcept;

  std::vector<ChannelRecord> channels_;
  SampleRate rate_;
  std::size_t samples_per_step_;
  std::size_t steps_per_message_;
  std::vector<std::int32_t> minimum_;  ///< channel by channel, steps_per_message_ each
  std::vector<std::int32_t> maximum_;
  Tick first_tick_ = 0;
  std::size_t samples_ = 0;  ///< in the message so far
  std::uint64_t missing_ = 0;
  bool started_ = false;
  bool complete_ = false;
};

}  // namespace kolsky

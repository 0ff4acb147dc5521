#pragma once

#include <atomic>
#include <cstdint>
#include <span>
#include <vector>

#include "processing/trigger/channel_level.hpp"
#include "processing/trigger/incident_trigger.hpp"
#include "processing/trigger/run_statistics.hpp"

namespace kolsky {

/// Where a channel's signal lies between pulses.
struct SignalLevel {
  double baseline_codes = 0.0;
  double noise_codes = 0.0;
  double level_codes = 0.0;           ///< 0 on channels that do not trigger
  std::int64_t constant_samples = 0;  ///< for how long the code has not changed
  bool learned = false;               ///< enough quiet samples were seen
};

/// The levels of all channels: followed by the acquisition thread, for any thread to read.
class LevelBoard {
 public:
  LevelBoard(std::size_t channels, const TriggerOptions& options)
      : quiet_(channels, ChannelLevel(options)), shown_(channels) {}

  // Acquisition thread.
  void forget() noexcept;
  /// After a block, by its statistics: the samples are not looked at again.
  /// @param statistics  one per channel
  /// @param trigger     of the channel that triggers, which has seen the block
  void follow(std::span<const RunStatistics> statistics, std::size_t trigger_channel,
              const IncidentTrigger& trigger) noexcept;

  // Any thread.
  [[nodiscard]] SignalLevel level(std::size_t channel) const noexcept;

 private:
  struct Shown {
    std::atomic<double> baseline{0.0};
    std::atomic<double> noise{0.0};
    std::atomic<double> level{0.0};
    std::atomic<std::int64_t> constant{0};
    std::atomic<bool> learned{false};
    std::int32_t last_code = 0;  ///< of the acquisition thread alone
  };

  static void show(const IncidentTrigger& trigger, Shown& shown) noexcept;
  static void show(const ChannelLevel& quiet, Shown& shown) noexcept;
  static void follow_constant(const RunStatistics& run, Shown& shown) noexcept;

  std::vector<ChannelLevel> quiet_;  ///< of the channels that do not trigger
  std::vector<Shown> shown_;
};

}  // namespace kolsky

#pragma once

#include <cstdint>

#include "processing/trigger/incident_trigger.hpp"
#include "processing/trigger/run_statistics.hpp"

namespace kolsky {

/// Baseline and noise of a channel that does not trigger, from the statistics of its runs alone: no
/// sample is looked at twice. Both fade with the noise's memory; a run with a pulse or a spike in
/// it (extremes beyond the trigger's level) is left out, until so many such runs have come that
/// they are what is usual now.
class ChannelLevel {
 public:
  /// Uses level, noise memory, least noise and learning of the trigger.
  explicit ChannelLevel(const TriggerOptions& options);

  void take(const RunStatistics& run) noexcept;
  void forget() noexcept;

  [[nodiscard]] double baseline_codes() const noexcept { return baseline_codes_; }
  /// Standard deviation about the mean of each run, not below the least noise.
  [[nodiscard]] double noise_codes() const noexcept;
  /// Enough quiet samples were seen.
  [[nodiscard]] bool learned() const noexcept { return samples_ >= learn_samples_; }

 private:
  [[nodiscard]] bool usual(const RunStatistics& run) const noexcept;

  double level_sigma_;
  double memory_samples_;
  double minimum_noise_codes_;
  double learn_samples_;

  double samples_ = 0.0;  ///< that the level rests on
  double unusual_samples_ = 0.0;
  double baseline_codes_ = 0.0;
  double variance_codes2_ = 0.0;
};

}  // namespace kolsky

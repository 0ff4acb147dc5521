#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "processing/base/shot.hpp"

namespace kolsky {

/// Sum, sum of squares and extremes of a run of codes: what tells a quiet run from one worth a look.
struct RunStatistics {
  std::int64_t count = 0;
  double sum = 0.0;
  double sum_of_squares = 0.0;
  std::int32_t minimum = 0;
  std::int32_t maximum = 0;
};

[[nodiscard]] RunStatistics run_statistics(std::span<const std::int16_t> codes) noexcept;
[[nodiscard]] RunStatistics run_statistics(std::span<const std::int32_t> codes) noexcept;

/// The same while copying, at little more than the cost of the copy. @pre equal sizes
RunStatistics copy_with_statistics(std::span<const std::int16_t> from, std::span<std::int16_t> to) noexcept;
RunStatistics copy_with_statistics(std::span<const std::int32_t> from, std::span<std::int32_t> to) noexcept;

struct TriggerOptions {
  double level_sigma = 8.0;        ///< level above the baseline, in standard deviations of the noise
  double hysteresis_share = 0.5;   ///< of the level: the signal must stay above this ...
  std::size_t minimum_width_samples = 8;  ///< ... for so long
  std::size_t maximum_rise_samples = 64;  ///< from half the level to the level: slower is drift, not a pulse
  std::size_t hold_off_samples = 0;       ///< after a trigger
  std::size_t learn_samples = 256;        ///< quiet samples before the first trigger may fire
  double minimum_noise_codes = 0.5;       ///< floor of the noise: a constant record must not trigger on one step
};

/// Finds the incident pulse in a stream of codes from one channel, either sign. The baseline and the noise
/// follow the stream while it is quiet; spikes fail the width, drift and hum the rise. O(1) memory, no
/// allocation after construction.
class IncidentTrigger {
 public:
  explicit IncidentTrigger(const TriggerOptions& options);

  /// Takes the next run of codes, whose first is at `first_tick`, with its statistics. Runs follow each
  /// other; after a hole call `reset_run` first.
  /// @return the trigger, when it has become certain in this run (its tick may lie in an earlier one):
  ///         the interpolated time at which the level was crossed
  std::optional<TriggerEvent> feed(Tick first_tick, std::span<const std::int16_t> codes,
                                   const RunStatistics& statistics);
  std::optional<TriggerEvent> feed(Tick first_tick, std::span<const std::int32_t> codes,
                                   const RunStatistics& statistics);

  /// Forgets the run in progress (a hole in the stream) but keeps baseline and noise.
  void reset_run();
  /// Forgets everything (another capture, another digitiser).
  void reset();

  [[nodiscard]] double baseline_codes() const { return baseline_; }
  [[nodiscard]] double noise_codes() const { return noise_; }
  [[nodiscard]] double level_codes() const { return options_.level_sigma * noise_; }
  [[nodiscard]] bool ready() const { return learned_ >= options_.learn_samples; }

 private:
  TriggerOptions options_;
  double baseline_ = 0.0;
  double noise_ = 0.0;
  std::size_t learned_ = 0;
};

}  // namespace kolsky

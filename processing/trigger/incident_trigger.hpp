#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "processing/base/shot.hpp"
#include "processing/trigger/baseline.hpp"
#include "processing/trigger/code_history.hpp"
#include "processing/trigger/run_statistics.hpp"

namespace kolsky {

/// Settings of the incident trigger, in samples of the stream. The defaults are those of
/// `for_rate(1e6)`; docs/trigger.md says how they were chosen.
struct TriggerOptions {
  double level_sigma = 8.0;  ///< level off the baseline, in standard deviations of the noise
  double hysteresis_share =
      0.5;  ///< of the level: the signal must stay beyond this share of it ...
  std::size_t minimum_width_samples =
      5;  ///< ... for so long, and over so long its mean reach the level
  std::size_t maximum_rise_samples =
      40;  ///< from the share to the level: slower is drift, not a pulse
  std::size_t hold_off_samples = 100'000;  ///< after a trigger; then the baseline is learned anew
  std::size_t learn_samples = 256;         ///< quiet samples before the first trigger may fire
  double minimum_noise_codes =
      0.5;  ///< floor of the noise: a constant record must not fire on one step
  std::size_t baseline_memory_samples = 256;  ///< the baseline's line rests on about twice as many
  std::size_t noise_memory_samples = 20'000;  ///< the noise is averaged over

  /// Widths for the same physical times at another rate: width 5 us (at least 4 samples), rise 40
  /// us (16), hold-off 0.1 s, learning 25 us (256), baseline memory 256 us (256), noise memory 20
  /// ms, which is one period of the mains.
  /// @throws InputError unless the rate is finite and positive
  [[nodiscard]] static TriggerOptions for_rate(double sampling_frequency_Hz);
};

/// @throws InputError whose place is the setting, as "level_sigma"
void check(const TriggerOptions& options);

/// Finds the incident pulse in a stream of codes from one channel, either sign. The baseline and
/// the noise follow the stream while it is quiet; spikes fail the width, drift and hum the rise.
/// What it finds does not depend on the pieces the stream comes in. No allocation after
/// construction.
class IncidentTrigger {
 public:
  /// @throws InputError as `check` does
  explicit IncidentTrigger(const TriggerOptions& options);

  /// Takes the next run of codes, whose first is at `first_tick`, with its statistics. Runs follow
  /// each other; a first tick other than the one expected counts as a hole and does what
  /// `reset_run` does.
  /// @return the trigger, once it is certain (its tick may lie in an earlier run): the time at
  /// which the
  ///         pulse crossed the level, and the error it has from the noise of the samples and from
  ///         what is not known of baseline and level. One per call; where a hold-off is shorter
  ///         than a run, up to eight more wait for the next calls.
  std::optional<TriggerEvent> feed(Tick first_tick, std::span<const std::int16_t> codes,
                                   const RunStatistics& statistics);
  std::optional<TriggerEvent> feed(Tick first_tick, std::span<const std::int32_t> codes,
                                   const RunStatistics& statistics);

  /// The stream has a hole here. Forgets the run in progress; a pulse that is already certain comes
  /// with the next call, timed by the samples before the hole. Keeps the noise and what is left of
  /// the hold-off, and reports the baseline as it was until `learn_samples` more have shown it
  /// anew.
  void reset_run();
  /// Forgets everything (another capture, another digitiser).
  void reset();

  [[nodiscard]] double baseline_codes() const { return baseline_codes_; }
  /// Standard deviation, not below minimum_noise_codes. The minimum before anything is learned.
  [[nodiscard]] double noise_codes() const;
  [[nodiscard]] double level_codes() const { return options_.level_sigma * noise_codes(); }
  /// Whether a pulse would be found now: not while learning nor in the hold-off.
  [[nodiscard]] bool ready() const { return phase_ == Phase::watching; }

 private:
  enum class Phase {
    learning,  ///< collecting samples for baseline and noise
    watching,
    settling,  ///< a pulse is certain; waiting for the samples that its time is fitted to
    holding,
  };
  /// What the samples of one cell of the baseline are judged by, and what is quiet of them.
  struct Cell {
    Tick first_tick = 0;
    BaselineLine line;
    double level = 0.0;
    double band = 0.0;
    std::int32_t lowest_quiet = 0;  ///< these and all between are within the band
    std::int32_t highest_quiet = 0;
    std::int32_t pivot = 0;
    DeviationSums quiet;
  };
  /// The samples out of the hysteresis band, as the last sample left it.
  struct Excursion {
    std::size_t tainted = 0;  ///< samples until the last one outside leaves the window of the mean
    std::size_t outside = 0;  ///< successive samples outside, on one side
    int side = 0;
    std::int64_t window_sum = 0;  ///< of the last minimum_width codes, valid while tainted
    Tick low_tick = 0;            ///< the last at which the mean was within the band
  };
  /// A pulse whose time is still to be fitted.
  struct Pulse {
    Tick found_tick = 0;
    Tick low_tick = 0;
    Tick fit_tick = 0;  ///< when enough samples are there
    int side = 0;
    Cell cell;
  };
  template <class Code>
  struct Run;

  template <class Code>
  std::optional<TriggerEvent> take(Tick first_tick, std::span<const Code> codes,
                                   const RunStatistics& statistics);
  template <class Code>
  Tick learn(const Run<Code>& run, Tick from);
  template <class Code>
  Tick watch(const Run<Code>& run, Tick from);
  template <class Code>
  bool pass_over(const Run<Code>& run, Tick from, Tick end);
  template <class Code>
  Tick pass_over_cells(const Run<Code>& run, Tick from);
  template <class Code>
  Tick look_closely(const Run<Code>& run, Tick from, Tick end);
  template <class Code>
  Tick settle(const Run<Code>& run, Tick from);
  template <class Code>
  void finish_pulse(const Run<Code>& run);
  template <class Code>
  TriggerEvent fit(const Run<Code>& run);
  template <class Code>
  std::span<double> deviations(const Run<Code>& run, Tick first, Tick end);

  void start_run(Tick tick);
  void start_learning(Tick tick);
  void start_cell(Tick tick);
  void finish_cell();
  void pass(Tick end, std::int64_t count, std::int64_t sum, std::int64_t sum_of_squares);
  void add_quiet(std::int64_t count, std::int64_t sum, std::int64_t sum_of_squares);
  [[nodiscard]] double line_at(const Cell& cell, double samples_after_first) const;
  [[nodiscard]] double mean_deviation(Tick tick) const;
  [[nodiscard]] bool within_band(const Extremes& codes) const;
  void keep(const TriggerEvent& event);
  std::optional<TriggerEvent> next_waiting();

  TriggerOptions options_;
  BaselineTracker tracker_;
  CodeHistory history_;
  std::vector<double> scratch_;

  Phase phase_ = Phase::learning;
  bool started_ = false;
  Tick next_tick_ = 0;
  Tick run_start_ = 0;    ///< first sample after the last hole
  Tick phase_start_ = 0;  ///< learning
  Tick hold_until_ = 0;   ///< holding
  Cell cell_;
  double level_variance_ = -1.0;  ///< of the noise, that the cell's level is for
  std::size_t noisy_cells_ = 0;   ///< successive cells with few quiet samples
  Excursion excursion_;
  Pulse pulse_;
  double baseline_codes_ = 0.0;
  std::array<TriggerEvent, 8> waiting_{};
  std::size_t waiting_count_ = 0;
};

}  // namespace kolsky

#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <optional>

#include "daemon/acquisition/acquisition_plan.hpp"
#include "daemon/acquisition/event_teller.hpp"
#include "drivers/digitiser/digitiser.hpp"

namespace kolsky {

/// Windows that were triggered and whose samples are still coming. What is full is handed over.
///
/// A window is [tick - pre, tick + post), cut where the stream or the capture begins or ends. A
/// replayed capture with a mark is one window whole, so that a stored shot comes back as it was
/// (where it fits the ring). All but the questions is for the acquisition thread; it neither locks
/// nor allocates.
class OpenWindows {
 public:
  /// @param ring_samples  how many the ring holds
  /// @param teller        outlives this
  OpenWindows(const StreamInfo& stream, std::size_t ring_samples, EventTeller& teller);

  /// Windows reach back to there at most.
  void begin_capture(Tick start) { capture_start_ = start; }
  /// Samples are in the ring up to there.
  void reach(Tick end, std::int64_t monotonic_ns);
  [[nodiscard]] Tick reached() const { return end_tick_; }

  void trigger_at(const TriggerEvent& trigger, const AcquisitionPlan& plan);
  /// A mark that the stream carries: of a replay the whole capture is its window.
  void take_mark(const TriggerEvent& mark, const AcquisitionPlan& plan);
  /// Before samples up to there are written: a marked capture that is longer than the ring after
  /// all is cut as any other.
  void cut_if_too_long(Tick end, const AcquisitionPlan& plan);

  void close_full();
  /// The capture has no more; its windows end with it.
  void end_capture();
  /// The stream broke off: what would follow is missing.
  void interrupt();

  // Any thread.
  [[nodiscard]] bool any() const noexcept { return open_count_.load() > 0; }
  [[nodiscard]] std::uint64_t triggers() const noexcept { return triggers_.load(); }
  /// Triggered, but too many windows were open or waiting.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_.load(); }

 private:
  static constexpr std::size_t kMost = 16;

  [[nodiscard]] bool fits_ring(Tick length) const;
  [[nodiscard]] Window about(const TriggerEvent& trigger, const AcquisitionPlan& plan) const;
  [[nodiscard]] Window whole(const TriggerEvent& mark) const;
  void tell(AcquisitionEvent::Kind kind, const Window& window);
  void tell_triggered(const Window& window);
  void open(const Window& window);
  void end_all(WindowEnd end);
  void hand_over(const Window& window);
  [[nodiscard]] std::int64_t monotonic_at(Tick tick) const noexcept;

  const StreamInfo stream_;
  const Tick ring_samples_;
  EventTeller& teller_;
  Tick capture_start_ = 0;
  Tick end_tick_ = 0;
  std::int64_t end_monotonic_ns_ = 0;
  /// The mark of a replayed capture that is still coming.
  std::optional<TriggerEvent> whole_capture_;
  std::array<Window, kMost> open_{};
  std::size_t opened_ = 0;

  std::atomic<std::size_t> open_count_{0};
  std::atomic<std::uint64_t> triggers_{0};
  std::atomic<std::uint64_t> refused_{0};
};

}  // namespace kolsky

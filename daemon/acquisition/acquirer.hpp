#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/acquisition/acquisition_event.hpp"
#include "daemon/acquisition/sample_ring.hpp"
#include "daemon/thread.hpp"
#include "daemon/thread_priority.hpp"
#include "drivers/digitiser/digitiser.hpp"
#include "processing/trigger/channel_level.hpp"
#include "processing/trigger/incident_trigger.hpp"

namespace kolsky {

/// What the acquisition thread watches for and cuts out.
struct AcquisitionPlan {
  std::size_t trigger_channel = 0;
  TriggerOptions trigger;
  std::int64_t pre_samples = 0;
  std::int64_t post_samples = 0;
};

/// Reads a digitiser into the ring on a thread of its own, watches the trigger channel and says
/// through a queue what happened. Waits only in `Digitiser::read` and while a device is gone; does
/// not allocate, lock or log. The one exception is a replay (a stream that ends): it may wait for
/// the recorder, because a file can, so that replaying as fast as possible loses nothing.
///
/// A window is [tick - pre, tick + post), cut where the stream or the capture begins or ends. A
/// mark that the stream carries is used in place of the software trigger for that capture; a
/// replayed capture with a mark is one window whole, so that a stored shot comes back as it was
/// (where it fits the ring).
class Acquirer {
 public:
  /// The digitiser, ring and queue must outlive the acquirer. The digitiser has been started.
  Acquirer(Digitiser& digitiser, SampleRing& ring, AcquisitionQueue& events,
           const AcquisitionPlan& plan);
  ~Acquirer();
  Acquirer(const Acquirer&) = delete;
  Acquirer& operator=(const Acquirer&) = delete;

  void start();
  /// Cancels the digitiser, closes open windows as interrupted and joins.
  void stop();

  // From any thread.
  void arm(bool armed) noexcept { armed_.store(armed, std::memory_order_release); }
  [[nodiscard]] bool armed() const noexcept { return armed_.load(std::memory_order_acquire); }
  /// Whether a pulse would be found now: the trigger is neither learning nor in its hold-off.
  [[nodiscard]] bool watching() const noexcept { return watching_.load(std::memory_order_acquire); }
  /// Opens a window at the next block, armed or not.
  void force() noexcept { force_.store(true, std::memory_order_release); }
  /// Takes another trigger and window from the next block on; the trigger learns anew.
  void change_plan(const AcquisitionPlan& plan);
  /// Recorder: the samples of the oldest window handed over are no longer needed.
  void release_window() noexcept;

  struct Counters {
    std::uint64_t samples_read = 0;
    std::uint64_t samples_missing = 0;
    std::uint64_t gaps_of_unknown_length = 0;
    std::uint64_t overflows = 0;
    std::uint64_t reconnects = 0;
    std::uint64_t triggers = 0;
    std::uint64_t windows_refused = 0;  ///< triggered, but too many windows were open or waiting
    std::uint64_t progress = 0;         ///< turns of the loop: what a watchdog looks at
  };
  [[nodiscard]] Counters counters() const noexcept;

  struct Level {
    double baseline_codes = 0.0;
    double noise_codes = 0.0;
    double level_codes = 0.0;           ///< 0 on channels that do not trigger
    std::int64_t constant_samples = 0;  ///< for how long the code has not changed
    bool learned = false;               ///< enough quiet samples were seen
  };
  [[nodiscard]] Level level(std::size_t channel) const noexcept;

  [[nodiscard]] bool connected() const noexcept { return connected_.load(); }
  [[nodiscard]] bool ended() const noexcept { return ended_.load(); }
  /// A window is open: triggered and not yet full.
  [[nodiscard]] bool capturing() const noexcept { return open_count_.load() > 0; }
  /// A window waits for the recorder: its shot is not cut yet.
  [[nodiscard]] bool recording() const noexcept { return handed_.load() != released_.load(); }
  /// Whether the thread runs at a real-time priority (asked for, not always permitted).
  [[nodiscard]] bool real_time() const noexcept { return real_time_.load(); }

 private:
  static constexpr std::size_t kOpenWindows = 16;

  struct Watch {
    explicit Watch(const AcquisitionPlan& p) : plan(p), trigger(p.trigger) {}
    AcquisitionPlan plan;
    IncidentTrigger trigger;
  };
  struct AtomicLevel {
    std::atomic<double> baseline{0.0};
    std::atomic<double> noise{0.0};
    std::atomic<double> level{0.0};
    std::atomic<std::int64_t> constant{0};
    std::atomic<bool> learned{false};
    std::int32_t last_code = 0;  ///< of the thread alone
  };

  void run();
  void go_real_time();
  void stay_polite();
  void take_plan();
  void learn_anew();
  void take(const Block& block);
  void note_missing(const Block& block);
  void begin_capture(const Block& block);
  void watch(const Block& block);
  std::optional<TriggerEvent> feed_trigger(const Block& block);
  void take_mark(const Block& block, const TriggerEvent& mark);
  void settle_long_mark(const Block& block);
  void trigger_at(const TriggerEvent& event);
  void open_window(const Window& window);
  void close_full_windows();
  void close_capture();
  void interrupt_windows();
  void hand_over(const Window& window);
  void tell(const AcquisitionEvent& event);
  void tell(AcquisitionEvent::Kind kind);
  void tell_gap(const AcquisitionEvent& event);
  [[nodiscard]] bool say_held_gap();
  void wait_for_room(Tick end_tick);
  [[nodiscard]] bool must_wait(Tick end_tick) const noexcept;
  void handle_disconnect();
  [[nodiscard]] bool same_stream() const;
  void pause(std::int64_t milliseconds) const;
  void follow_quiet_channels();
  void show_levels();
  void show_trigger_level(AtomicLevel& level);
  static void follow_constant(AtomicLevel& level, const RunStatistics& run);
  [[nodiscard]] std::int64_t monotonic_at(Tick tick) const noexcept;

  Digitiser& digitiser_;
  SampleRing& ring_;
  AcquisitionQueue& events_;
  const StreamInfo stream_;
  Watch watch_;
  std::vector<ChannelLevel> quiet_;  ///< of the channels that do not trigger
  std::vector<RunStatistics> statistics_;
  std::vector<AtomicLevel> levels_;

  // Of the thread alone.
  IdleCheck idle_check_;
  bool streaming_ = false;  ///< a block has come
  Tick end_tick_ = 0;
  std::int64_t end_monotonic_ns_ = 0;
  Tick capture_start_ = 0;
  bool capture_marked_ = false;
  bool overflow_pending_ = false;
  std::optional<AcquisitionEvent> held_gap_;  ///< found no room; goes ahead of whatever comes next
  std::optional<TriggerEvent>
      whole_capture_;  ///< the mark of a replayed capture that is still coming
  std::array<Window, kOpenWindows> open_{};
  std::size_t opened_ = 0;
  std::array<Tick, AcquisitionQueue::capacity()> handed_first_{};

  std::atomic<std::uint32_t> handed_{0};
  std::atomic<std::uint32_t> released_{0};
  std::atomic<Watch*> next_watch_{nullptr};
  std::atomic<Watch*> retired_watch_{nullptr};
  std::atomic<bool> stop_{false};
  std::atomic<bool> armed_{false};
  std::atomic<bool> watching_{false};
  std::atomic<bool> force_{false};
  std::atomic<bool> connected_{true};
  std::atomic<bool> ended_{false};
  std::atomic<bool> real_time_{false};
  std::atomic<std::size_t> open_count_{0};
  std::atomic<std::uint64_t> samples_read_{0};
  std::atomic<std::uint64_t> samples_missing_{0};
  std::atomic<std::uint64_t> unknown_gaps_{0};
  std::atomic<std::uint64_t> overflows_{0};
  std::atomic<std::uint64_t> reconnects_{0};
  std::atomic<std::uint64_t> triggers_{0};
  std::atomic<std::uint64_t> refused_{0};
  std::atomic<std::uint64_t> progress_{0};
  Thread thread_;
};

}  // namespace kolsky

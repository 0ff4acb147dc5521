#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <vector>

#include "daemon/acquisition/acquisition_plan.hpp"
#include "daemon/acquisition/event_teller.hpp"
#include "daemon/acquisition/exchange.hpp"
#include "daemon/acquisition/level_board.hpp"
#include "daemon/acquisition/open_windows.hpp"
#include "daemon/acquisition/sample_ring.hpp"
#include "daemon/thread.hpp"
#include "daemon/thread_priority.hpp"
#include "drivers/digitiser/digitiser.hpp"
#include "processing/trigger/incident_trigger.hpp"
#include "processing/trigger/run_statistics.hpp"

namespace kolsky {

/// Reads a digitiser into the ring on a thread of its own, watches the trigger channel and says
/// through a queue what happened. Waits only in `Digitiser::read` and while a device is gone; does
/// not allocate, lock or log. The one exception is a replay (a stream that ends): it may wait for
/// the recorder, because a file can, so that replaying as fast as possible loses nothing.
///
/// A mark that the stream carries is used in place of the software trigger for that capture.
class Acquirer {
 public:
  /// The digitiser, ring and queue must outlive the acquirer. The digitiser has been started.
  Acquirer(Digitiser& digitiser, SampleRing& ring, AcquisitionQueue& events,
           const AcquisitionPlan& plan);
  ~Acquirer() { stop(); }
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
  void release_window() noexcept { teller_.release_window(); }

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

  [[nodiscard]] SignalLevel level(std::size_t channel) const noexcept {
    return levels_.level(channel);
  }

  [[nodiscard]] bool connected() const noexcept { return connected_.load(); }
  [[nodiscard]] bool ended() const noexcept { return ended_.load(); }
  /// A window is open: triggered and not yet full.
  [[nodiscard]] bool capturing() const noexcept { return windows_.any(); }
  /// A window waits for the recorder: its shot is not cut yet.
  [[nodiscard]] bool recording() const noexcept { return teller_.any_window_needed(); }
  /// Whether the thread runs at a real-time priority (asked for, not always permitted).
  [[nodiscard]] bool real_time() const noexcept { return real_time_.load(); }

 private:
  struct Watch {
    explicit Watch(const AcquisitionPlan& p) : plan(p), trigger(p.trigger) {}
    AcquisitionPlan plan;
    IncidentTrigger trigger;
  };

  void run();
  void go_real_time();
  void stay_polite();
  void learn_anew();
  void take(const Block& block);
  void note_missing(const Block& block);
  void begin_capture(const Block& block);
  void end_capture();
  void watch(const Block& block);
  [[nodiscard]] std::optional<TriggerEvent> feed_trigger(const Block& block);
  void tell(AcquisitionEvent::Kind kind);
  void wait_for_room(Tick end_tick);
  [[nodiscard]] bool must_wait(Tick end_tick) const noexcept;
  void handle_disconnect();
  [[nodiscard]] bool same_stream() const;
  void pause(std::int64_t milliseconds) const;

  Digitiser& digitiser_;
  SampleRing& ring_;
  const StreamInfo stream_;
  EventTeller teller_;
  OpenWindows windows_;
  LevelBoard levels_;
  Exchange<Watch> next_watch_;

  // Of the thread alone.
  Watch watch_;
  std::vector<RunStatistics> statistics_;  ///< by channel, of the last block
  IdleCheck idle_check_;
  bool streaming_ = false;  ///< a block has come
  bool capture_marked_ = false;
  bool overflow_pending_ = false;

  std::atomic<bool> stop_{false};
  std::atomic<bool> armed_{false};
  std::atomic<bool> watching_{false};
  std::atomic<bool> force_{false};
  std::atomic<bool> connected_{true};
  std::atomic<bool> ended_{false};
  std::atomic<bool> real_time_{false};
  std::atomic<std::uint64_t> samples_read_{0};
  std::atomic<std::uint64_t> samples_missing_{0};
  std::atomic<std::uint64_t> unknown_gaps_{0};
  std::atomic<std::uint64_t> overflows_{0};
  std::atomic<std::uint64_t> reconnects_{0};
  std::atomic<std::uint64_t> progress_{0};
  Thread thread_;
};

}  // namespace kolsky

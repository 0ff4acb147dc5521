#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "daemon/acquisition/acquirer.hpp"
#include "daemon/acquisition/acquisition_event.hpp"
#include "daemon/acquisition/sample_ring.hpp"
#include "daemon/publish/publisher.hpp"
#include "daemon/shots/archivist.hpp"
#include "daemon/shots/gap_log.hpp"
#include "daemon/shots/loss_rate.hpp"
#include "daemon/shots/reducing_thread.hpp"
#include "daemon/shots/shared_journal.hpp"
#include "daemon/shots/shot_id.hpp"
#include "daemon/thread.hpp"

namespace kolsky {

/// What the next shots are made from.
struct ShotSettings {
  Shot blank;  ///< all but the samples
  std::string bench_path;
  std::int64_t pre_samples = 0;
  std::int64_t post_samples = 0;
};

/// How long one stage of a shot's way took.
struct StageDuration {
  const char* stage = "";
  double duration_s = 0.0;
};

class Stopwatch;

/// The thread that makes shots out of complete windows: copies the window from the ring, journals
/// it, reduces it while the disk takes it, publishes both and hands it to the archivist. Nothing is
/// published before it is durable. It also publishes what the acquisition thread reports as lost.
class ShotRecorder {
 public:
  /// Everything referred to must outlive the recorder.
  struct Parts {
    const SampleRing& ring;
    AcquisitionQueue& events;
    Acquirer& acquirer;
    SharedJournal& journal;
    Archivist& archivist;
    Publisher& publisher;
    const StoreLayout& store;
    bool real_time = false;                 ///< ask for real-time scheduling
    std::vector<PlayedCapture> captures{};  ///< of a replay
    /// Told of every shot once its result is out, by the recorder's thread: must not wait.
    std::function<void(const std::shared_ptr<const Shot>&)> published{};
  };
  ShotRecorder(const Parts& parts, std::shared_ptr<const ShotSettings> settings);
  ~ShotRecorder();
  ShotRecorder(const ShotRecorder&) = delete;
  ShotRecorder& operator=(const ShotRecorder&) = delete;

  /// Rehearses one shot, so that plans, tables and buffers are there before the first, and begins.
  /// @throws InputError where the bench cannot be reduced at all
  void start();
  /// Joins; the queue has been closed, and what is in it is worked off.
  void stop();

  /// From any thread: for the shots to come. Rehearses with the new settings.
  /// @throws InputError, as `start`, and then nothing is changed
  void change(std::shared_ptr<const ShotSettings> settings);

  struct Counters {
    std::uint64_t shots_journaled = 0;
    std::uint64_t journal_failures = 0;
    std::uint64_t ring_overruns = 0;
    std::uint64_t progress = 0;
  };
  [[nodiscard]] Counters counters() const noexcept;
  [[nodiscard]] bool busy() const noexcept { return busy_.load(); }
  /// The stream's end was reached and all before it is recorded.
  [[nodiscard]] bool seen_end() const noexcept { return seen_end_.load(); }
  [[nodiscard]] std::string last_shot_id() const;
  [[nodiscard]] std::vector<StageDuration> last_timings() const;

 private:
  struct Messages;

  void rehearse(const ShotSettings& settings);
  void run();
  void handle(const AcquisitionEvent& event);
  void record(const Window& window);
  [[nodiscard]] std::shared_ptr<Shot> cut(const Window& whole);
  /// A step of the journal's. @return whether it was done; if not, a fault says why
  [[nodiscard]] bool journaled(const Shot& shot, const std::function<void()>& step);
  void file_unjournaled(const std::shared_ptr<Shot>& shot);
  void announce(const Shot& shot, Stopwatch& watch);
  void name_captures_without_shot() const;
  void tell_loss(const AcquisitionEvent& event);
  void tell_losses_kept_back(Tick tick, std::int64_t now_ns);
  void report_loss(const AcquisitionEvent& event);
  void fault(const char* kind, const std::string& text, Tick tick, std::uint64_t samples);
  [[nodiscard]] std::shared_ptr<const ShotSettings> settings() const;

  Parts parts_;
  GapLog gaps_;
  LossRate losses_;
  std::set<std::string> played_;  ///< captures of which a shot came
  ShotIdSource ids_;
  std::unique_ptr<Messages> messages_;

  ReducingThread reducing_;

  mutable std::mutex mutex_;
  std::shared_ptr<const ShotSettings> settings_;
  std::string last_shot_id_;
  std::vector<StageDuration> last_timings_;

  std::atomic<std::uint64_t> journaled_{0};
  std::atomic<std::uint64_t> journal_failures_{0};
  std::atomic<std::uint64_t> overruns_{0};
  std::atomic<std::uint64_t> progress_{0};
  std::atomic<bool> busy_{false};
  std::atomic<bool> seen_end_{false};
  Thread thread_;
};

}  // namespace kolsky

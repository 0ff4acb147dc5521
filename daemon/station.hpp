#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>

#include "daemon/acquisition/acquirer.hpp"
#include "daemon/acquisition/sample_ring.hpp"
#include "daemon/config.hpp"
#include "daemon/critic/diagnosis_desk.hpp"
#include "daemon/critic/shot_critic.hpp"
#include "daemon/publish/publisher.hpp"
#include "daemon/shots/archivist.hpp"
#include "daemon/shots/recorder.hpp"
#include "daemon/shots/shared_journal.hpp"
#include "daemon/shots/store_lock.hpp"
#include "drivers/digitiser/digitiser.hpp"
#include "drivers/files/store/store.hpp"

namespace kolsky {

/// The parts of a running daemon, in the order in which they come to be: store, sockets, digitiser,
/// threads. Opening it recovers the store, binds the results and preview sockets and opens the
/// digitiser; `start` lets the samples in.
class Station {
 public:
  /// @throws InputError for whatever the configuration has wrong
  explicit Station(DaemonConfig config);
  ~Station();
  Station(const Station&) = delete;
  Station& operator=(const Station&) = delete;

  void start();
  /// Stops reading, records what is in hand and stores it. Also done by the destructor.
  void stop();

  /// A replay is over, and all its shots are recorded.
  [[nodiscard]] bool ended() const { return recorder_.seen_end(); }
  /// ... and stored.
  [[nodiscard]] bool finished() const {
    return ended() && !recorder_.busy() && archivist_.idle() && critic_.idle();
  }
  [[nodiscard]] bool started() const { return started_.load(); }

  [[nodiscard]] const EndpointConfig& endpoints() const { return endpoints_; }
  [[nodiscard]] const StoreLayout& store() const { return store_; }
  [[nodiscard]] const StreamInfo& stream() const { return stream_; }
  [[nodiscard]] const SampleRing& ring() const { return ring_; }
  [[nodiscard]] Digitiser& digitiser() { return *digitiser_; }
  [[nodiscard]] Publisher& publisher() { return publisher_; }
  [[nodiscard]] Acquirer& acquirer() { return acquirer_; }
  [[nodiscard]] ShotRecorder& recorder() { return recorder_; }
  [[nodiscard]] Archivist& archivist() { return archivist_; }
  [[nodiscard]] ShotCritic& critic() { return critic_; }
  [[nodiscard]] DiagnosisDesk& diagnoses() { return diagnoses_; }
  /// What the next shots are made from; replaced whole.
  [[nodiscard]] std::shared_ptr<const ShotSettings> settings() const;

  /// Reads configuration and bench again and takes what can change while the digitiser runs: bench,
  /// bar model, model, trigger, window, meta. @throws InputError where it is wrong or asks for what
  /// needs a restart
  void reload();

 private:
  [[nodiscard]] DigitiserOptions options_for_digitiser();
  [[nodiscard]] AcquisitionPlan plan(const DaemonConfig& config, std::size_t trigger_channel) const;
  void fault(const char* kind, const std::string& text);

  const EndpointConfig endpoints_;
  DaemonConfig config_;  ///< with `apparatus_`, of whoever starts and reloads: one thread at a time
  Apparatus apparatus_;
  StoreLayout store_;
  StoreLock lock_;
  Publisher publisher_;
  SharedJournal journal_;
  std::unique_ptr<Digitiser> digitiser_;
  const StreamInfo stream_;
  std::shared_ptr<const ShotSettings> settings_;
  mutable std::mutex settings_mutex_;
  SampleRing ring_;
  AcquisitionQueue events_;
  Acquirer acquirer_;
  Archivist archivist_;
  ShotCritic critic_;
  DiagnosisDesk diagnoses_;
  ShotRecorder recorder_;
  std::atomic<bool> started_{false};
  bool stopped_ = false;
};

}  // namespace kolsky

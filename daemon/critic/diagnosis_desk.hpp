#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "daemon/critic/active_model.hpp"
#include "daemon/publish/publisher.hpp"
#include "daemon/shots/archivist.hpp"
#include "daemon/thread.hpp"
#include "drivers/files/store/store.hpp"

namespace kolsky {

struct Diagnosis;
struct Misfit;

/// Diagnoses stored shots when a client asks for it: one at a time, in a thread of its own at the
/// lowest priority, on one processor. Publishes every step and the outcome, and files the outcome
/// in the store's folder `diagnoses`: ID.json, and ID.toml, the model with what was found. Nothing
/// there is ever replaced.
class DiagnosisDesk {
 public:
  static constexpr std::size_t kUsualShots = 8;
  static constexpr std::size_t kMostShots = 256;

  /// Everything referred to must outlive the desk.
  DiagnosisDesk(Publisher& publisher, Archivist& archivist, StoreLayout store);
  ~DiagnosisDesk();
  DiagnosisDesk(const DiagnosisDesk&) = delete;
  DiagnosisDesk& operator=(const DiagnosisDesk&) = delete;

  /// Begins with the newest shots, or those named; `begun` says under which id.
  /// @throws InputError where one is under way, no model is active, or there are no such shots
  void begin(std::shared_ptr<const ActiveModel> model, const v1::Diagnose& request,
             v1::Diagnosis& begun);
  /// Asks it to end at the next step. @throws InputError where none is under way
  void cancel();
  /// The one under way, or the last. @return whether there is one
  [[nodiscard]] bool last(v1::Diagnosis& diagnosis) const;
  /// Cancels and waits; none begins any more.
  void stop();

 private:
  void work(const std::shared_ptr<const ActiveModel>& model, const std::vector<std::string>& ids);
  void examine(const ActiveModel& model, const std::vector<std::string>& ids);
  /// @param left  by the model that the diagnosis ends with, as `compare` has it
  void file(const ActiveModel& model, const Diagnosis& diagnosis, const Misfit& left,
            const std::vector<std::filesystem::path>& captures);
  /// Publishes the diagnosis at a step. @throws Cancelled where that was asked for
  void step(const std::string& what);
  void heed_cancel() const;
  /// @pre mutex_ is held
  [[nodiscard]] bool under_way() const;
  void publish(const std::function<void(v1::Diagnosis&)>& change);

  Publisher& publisher_;
  Archivist& archivist_;
  StoreLayout store_;
  std::mutex begin_mutex_;  ///< of whoever begins or joins `thread_`; before `mutex_`
  mutable std::mutex mutex_;
  std::unique_ptr<v1::Diagnosis> last_;
  std::uint64_t count_ = 0;
  bool stopped_ = false;
  std::atomic<bool> cancel_{false};
  Thread thread_;
};

}  // namespace kolsky

#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <semaphore>

#include "daemon/thread.hpp"
#include "processing/base/shot.hpp"
#include "processing/reduction/reducer.hpp"

namespace kolsky {

/// Reduces one shot while the caller does something else with it: waits for the disk. First among
/// the ordinary threads and no more, since a real-time one would keep the disk's own work waiting;
/// where it has not come to the shot by the time that is wanted, the caller does it.
class ReducingThread {
 public:
  ReducingThread();
  ~ReducingThread();
  ReducingThread(const ReducingThread&) = delete;
  ReducingThread& operator=(const ReducingThread&) = delete;

  /// Reduces `shot` here and now, so that plans, tables and buffers are there for those to come.
  /// From any thread.
  /// @throws InputError where it cannot be reduced
  [[nodiscard]] Reduction rehearse(const Shot& shot);

  /// Hands `shot` over and returns at once. One thread begins and finishes, in turns.
  void begin(std::shared_ptr<const Shot> shot);
  /// The reduction of what was handed over; one that is not reducible says why.
  [[nodiscard]] Reduction finish();

 private:
  void run();
  /// For whoever comes first. @return whether it waited
  bool reduce_if_it_waits();

  std::mutex reducer_mutex_;  ///< contended only by a rehearsal
  Reducer reducer_;

  // These belong to whoever took `waits_` down, and to the caller once it has finished.
  std::shared_ptr<const Shot> shot_;
  Reduction reduction_;
  std::atomic<bool> waits_ = false;
  std::atomic<bool> ends_ = false;
  std::counting_semaphore<> begun_{0};  ///< the thread may come late and find nothing
  std::binary_semaphore finished_{0};
  Thread thread_;
};

}  // namespace kolsky

#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>

#include "daemon/thread.hpp"

namespace kolsky {

/// A thread that carries out tasks one after the other, in the order they were posted. Tasks do not
/// throw.
class Worker {
 public:
  /// @param name  of its thread
  Worker(const char* name, std::size_t most_waiting);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// @return false, and the task is not taken, while too many wait and once it is finishing
  [[nodiscard]] bool post(std::function<void()> task);
  /// Carries out what waits and ends the thread.
  void finish();

 private:
  void run();

  const std::size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool finishing_ = false;
  Thread thread_;
};

}  // namespace kolsky

#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

namespace kolsky {

/// Looks several times a second whether a refill has been waiting too long, which it may do for
/// good after a cable was pulled or while a server answers a byte at a time, and then calls
/// `cancel` from its own thread.
class RefillWatchdog {
 public:
  RefillWatchdog(std::chrono::milliseconds longest, std::function<void()> cancel);
  ~RefillWatchdog();
  RefillWatchdog(const RefillWatchdog&) = delete;
  RefillWatchdog& operator=(const RefillWatchdog&) = delete;

  /// Around a refill, on the reading thread: neither waits nor locks.
  void begin() noexcept;
  void end() noexcept;

 private:
  void watch();
  [[nodiscard]] bool too_long() const noexcept;

  std::chrono::milliseconds longest_;
  std::function<void()> cancel_;
  std::atomic<std::int64_t> begun_ns_{0};  ///< 0: no refill waits
  std::mutex mutex_;
  std::condition_variable stop_changed_;
  bool stop_ = false;
  std::thread thread_;
};

}  // namespace kolsky

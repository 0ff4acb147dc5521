#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "daemon/controller.hpp"
#include "daemon/live/thread_watch.hpp"
#include "daemon/station.hpp"
#include "daemon/thread.hpp"

namespace kolsky {

class Previewer;

/// What goes on beside the shots: the preview of the stream, the heartbeat, arming by itself where
/// that is set, and the watchdog.
class Monitor {
 public:
  Monitor(Station& station, Controller& controller, bool auto_arm);
  ~Monitor();
  Monitor(const Monitor&) = delete;
  Monitor& operator=(const Monitor&) = delete;

  void start();
  void stop();

 private:
  void run();
  void turn(std::chrono::steady_clock::time_point now);
  void preview();
  void arm_by_itself();
  void watch_threads(std::chrono::steady_clock::time_point now);

  Station& station_;
  Controller& controller_;
  bool auto_arm_;
  std::string last_refusal_;
  std::shared_ptr<const ShotSettings> previewed_;  ///< the channels as they are called now
  std::unique_ptr<Previewer> previewer_;
  ThreadWatch threads_;
  std::string stuck_;
  int last_state_ = 0;
  std::uint64_t last_stored_ = 0;
  std::chrono::steady_clock::time_point next_heartbeat_;
  std::chrono::steady_clock::time_point next_watchdog_;
  std::chrono::microseconds watchdog_interval_{0};
  std::atomic<bool> stop_{false};
  Thread thread_;
};

}  // namespace kolsky

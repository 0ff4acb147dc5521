#pragma once

#include <cstdint>

namespace kolsky {

/// Real-time priorities of the threads between a sample and its result; the others run as all
/// programs do. Reading goes before recording.
enum class RealTime : int { recording = 10, reading = 20 };

/// Asks for real-time scheduling of the calling thread; threads that it makes run as usual.
/// @return whether it was permitted
bool run_in_real_time(RealTime priority) noexcept;
/// @return whether it does now
bool run_as_usual() noexcept;
/// Ahead of what runs as usual, where that is permitted, and behind the kernel's own work.
void run_ahead_of_usual() noexcept;

/// Tells when the calling thread has been at work nearly all the time. A real-time thread that does
/// not sleep takes a processor from everybody else for good, so it should go back to running as
/// usual.
class IdleCheck {
 public:
  /// Call often. @return false once a second of nearly nothing but work has passed
  [[nodiscard]] bool rests() noexcept;

 private:
  std::int64_t looked_ns_ = 0;
  std::int64_t worked_ns_ = 0;
};

}  // namespace kolsky

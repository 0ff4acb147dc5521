#pragma once

namespace kolsky {

/// Real-time priorities of the threads between a sample and its result; the others run as all
/// programs do. Reading goes before recording.
enum class RealTime : int { recording = 10, reading = 20 };

/// Names the calling thread and asks for real-time scheduling. @return whether it was permitted
bool run_in_real_time(const char* name, RealTime priority) noexcept;
void name_thread(const char* name) noexcept;

}  // namespace kolsky

#include "daemon/live/thread_watch.hpp"

#include <utility>

namespace kolsky {

void ThreadWatch::add(std::string name, std::chrono::milliseconds patience,
                      std::function<Pulse()> pulse) {
  threads_.push_back({.name = std::move(name), .patience = patience, .pulse = std::move(pulse)});
}

std::optional<std::string> ThreadWatch::find_stuck(std::chrono::steady_clock::time_point now) {
  std::optional<std::string> stuck;
  for (Watched& thread : threads_) {
    const Pulse pulse = thread.pulse();
    if (!thread.seen || !pulse.has_work || pulse.progress != thread.last_progress) {
      thread.seen = true;
      thread.last_progress = pulse.progress;
      thread.last_change = now;
    } else if (now - thread.last_change > thread.patience && !stuck) {
      stuck = thread.name;
    }
  }
  return stuck;
}

}  // namespace kolsky

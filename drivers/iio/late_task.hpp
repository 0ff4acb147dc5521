#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <optional>
#include <thread>
#include <utility>

namespace kolsky {

/// Runs a task on a thread of its own and waits for it at most so long, or until `stop()`: what
/// libiio does on a control connection has no cancel, and a server that answers a byte at a time
/// holds it for good. A late task is left to end by itself; its result is thrown away, so it must
/// own what it uses.
/// @return none if the task was late or stopped waiting for @throws what the task throws
template <typename Result>
std::optional<Result> run_within(std::chrono::milliseconds longest, std::function<Result()> task,
                                 const std::function<bool()>& stop) {
  constexpr std::chrono::milliseconds kLook{20};
  std::packaged_task<Result()> packaged(std::move(task));
  std::future<Result> future = packaged.get_future();
  std::thread(std::move(packaged)).detach();
  const auto deadline = std::chrono::steady_clock::now() + longest;
  while (future.wait_for(kLook) != std::future_status::ready) {
    if (stop() || std::chrono::steady_clock::now() >= deadline) {
      return std::nullopt;
    }
  }
  return future.get();
}

}  // namespace kolsky

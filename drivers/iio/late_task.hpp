#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "processing/base/error.hpp"

namespace kolsky {

/// Runs a task on a thread of its own and waits for it at most so long, or until `stop()`: what
/// libiio does on a control connection has no cancel, and a server that answers a byte at a time
/// holds it for good. A late task is left to end by itself; its result is thrown away, so it must
/// own what it uses. It throws nothing but InputError. What a task in time owned is gone when this
/// returns.
/// @return none if the task was late or stopped waiting for
/// @throws InputError that the task threw
template <typename Result>
std::optional<Result> run_within(std::chrono::milliseconds longest, std::function<Result()> task,
                                 const std::function<bool()>& stop) {
  struct Outcome {
    std::mutex mutex;
    std::condition_variable done;
    std::optional<Result> result;
    std::optional<std::array<std::string, 3>> error;  // not the exception: threads share no text
  };
  const auto outcome = std::make_shared<Outcome>();
  std::thread([outcome, task = std::move(task)]() mutable {
    std::optional<Result> result;
    std::optional<std::array<std::string, 3>> error;
    try {
      result = task();
    } catch (const InputError& thrown) {
      error = {thrown.place(), thrown.problem(), thrown.mend()};
    }
    task = nullptr;  // lets go of what it owned before anybody is told that it has ended
    const std::lock_guard lock(outcome->mutex);
    outcome->result = std::move(result);
    outcome->error = std::move(error);
    outcome->done.notify_one();
  }).detach();
  constexpr std::chrono::milliseconds kLook{20};
  const auto deadline = std::chrono::steady_clock::now() + longest;
  std::unique_lock lock(outcome->mutex);
  const auto ready = [&] { return outcome->result || outcome->error; };
  while (!outcome->done.wait_for(lock, kLook, ready)) {
    if (stop() || std::chrono::steady_clock::now() >= deadline) {
      return std::nullopt;
    }
  }
  if (outcome->error) {
    auto& [place, problem, mend] = *outcome->error;
    throw InputError(std::move(place), std::move(problem), std::move(mend));
  }
  return std::move(outcome->result);
}

}  // namespace kolsky

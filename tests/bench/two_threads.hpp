#pragma once

#include <atomic>
#include <thread>

#include "processing/base/workers.hpp"

namespace kolsky {

/// The two threads that bounds are stated for.
inline Workers two_threads() {
  Workers two;
  two.workers = 2;
  two.run = [](std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
    std::atomic<std::size_t> next = 0;
    const auto loop = [&](std::size_t worker) {
      for (std::size_t i = next++; i < count; i = next++) {
        work(i, worker);
      }
    };
    std::jthread other(loop, 1);
    loop(0);
  };
  return two;
}

}  // namespace kolsky

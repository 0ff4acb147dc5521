#include "clients/cli/threads.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace kolsky::cli {

namespace {

void spread(std::size_t threads, std::size_t count,
            const std::function<void(std::size_t, std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex lock;
  std::exception_ptr thrown;
  const auto loop = [&](std::size_t worker) {
    for (std::size_t index = next++; index < count; index = next++) {
      try {
        work(index, worker);
      } catch (...) {
        const std::scoped_lock hold(lock);
        thrown = std::current_exception();
        next = count;
      }
    }
  };
  {
    std::vector<std::jthread> pool;
    for (std::size_t worker = 1; worker < std::min(threads, count); ++worker) {
      pool.emplace_back(loop, worker);
    }
    loop(0);
  }
  if (thrown) {
    std::rethrow_exception(thrown);
  }
}

}  // namespace

Workers all_cores() {
  Workers workers;
  workers.workers = std::max(1U, std::thread::hardware_concurrency());
  workers.run = [threads = workers.workers](
                    std::size_t count, const std::function<void(std::size_t, std::size_t)>& work) {
    spread(threads, count, work);
  };
  return workers;
}

}  // namespace kolsky::cli

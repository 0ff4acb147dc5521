#include "clients/cli/thread_executor.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace kolsky::cli {

Executor thread_executor() {
  return [](std::size_t count, const std::function<void(std::size_t)>& task) {
    std::atomic<std::size_t> next = 0;
    std::mutex lock;
    std::exception_ptr thrown;
    const auto work = [&] {
      for (std::size_t i = next++; i < count; i = next++) {
        try {
          task(i);
        } catch (...) {
          const std::scoped_lock hold(lock);
          thrown = std::current_exception();
          next = count;
        }
      }
    };
    const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1,
                                                        std::max<std::size_t>(count, 1));
    {
      std::vector<std::jthread> pool;
      for (std::size_t i = 1; i < threads; ++i) {
        pool.emplace_back(work);
      }
      work();
    }
    if (thrown) {
      std::rethrow_exception(thrown);
    }
  };
}

}  // namespace kolsky::cli

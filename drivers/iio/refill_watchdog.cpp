#include "drivers/iio/refill_watchdog.hpp"

#include <utility>

#include "drivers/iio/monotonic.hpp"

namespace kolsky {
namespace {

constexpr std::chrono::milliseconds kLook{200};

}  // namespace

RefillWatchdog::RefillWatchdog(std::chrono::milliseconds longest, std::function<void()> cancel)
    : longest_(longest), cancel_(std::move(cancel)), thread_([this] { watch(); }) {}

RefillWatchdog::~RefillWatchdog() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  stop_changed_.notify_all();
  thread_.join();
}

void RefillWatchdog::begin() noexcept {
  begun_ns_.store(monotonic_ns(), std::memory_order_relaxed);
}

void RefillWatchdog::end() noexcept {
  begun_ns_.store(0, std::memory_order_relaxed);
}

bool RefillWatchdog::too_long() const noexcept {
  const std::int64_t begun_ns = begun_ns_.load(std::memory_order_relaxed);
  return begun_ns != 0 && monotonic_ns() - begun_ns > std::chrono::nanoseconds(longest_).count();
}

void RefillWatchdog::watch() {
  std::unique_lock lock(mutex_);
  while (!stop_changed_.wait_for(lock, kLook, [this] { return stop_; })) {
    if (too_long()) {
      cancel_();
    }
  }
}

}  // namespace kolsky

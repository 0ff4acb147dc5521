#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace kolsky {

/// First in, first out between one producer that never waits and one consumer that may. Fixed size,
/// no locks, no allocation. T is copied.
template <typename T, std::size_t kCapacity>
class EventQueue {
  static_assert((kCapacity & (kCapacity - 1)) == 0, "the capacity is a power of two");

 public:
  static constexpr std::size_t capacity() noexcept { return kCapacity; }

  /// Producer. @return whether there was room
  bool push(const T& item) noexcept {
    const std::uint32_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - head_.load(std::memory_order_acquire) == kCapacity) {
      return false;
    }
    items_[tail % kCapacity] = item;
    tail_.store(tail + 1, std::memory_order_release);
    wake();
    return true;
  }

  /// Consumer; does not wait. @return whether there was an item
  bool pop(T& item) noexcept {
    const std::uint32_t head = head_.load(std::memory_order_relaxed);
    if (head == tail_.load(std::memory_order_acquire)) {
      return false;
    }
    item = items_[head % kCapacity];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// Consumer; waits for an item. @return false once the queue is closed and empty
  bool pop_wait(T& item) noexcept {
    for (;;) {
      const std::uint32_t seen = wakeups_.load(std::memory_order_acquire);
      if (pop(item)) {
        return true;
      }
      if (closed_.load(std::memory_order_acquire)) {
        return pop(item);
      }
      wakeups_.wait(seen, std::memory_order_acquire);
    }
  }

  /// How many items wait. Exact for neither side while the other is at work.
  [[nodiscard]] std::size_t size() const noexcept {
    return tail_.load(std::memory_order_acquire) - head_.load(std::memory_order_acquire);
  }

  /// No more items will come; from any thread.
  void close() noexcept {
    closed_.store(true, std::memory_order_release);
    wake();
  }

 private:
  void wake() noexcept {
    wakeups_.fetch_add(1, std::memory_order_release);
    wakeups_.notify_one();
  }

  std::array<T, kCapacity> items_{};
  alignas(64) std::atomic<std::uint32_t> head_{0};
  alignas(64) std::atomic<std::uint32_t> tail_{0};
  alignas(64) std::atomic<std::uint32_t> wakeups_{0};
  std::atomic<bool> closed_{false};
};

}  // namespace kolsky

#pragma once

#include <atomic>
#include <memory>
#include <utility>

namespace kolsky {

/// Gives a thread that must not wait, allocate or free another T than the one it has. What it had
/// is freed by the giver: with the next gift, or here in the end.
template <typename T>
class Exchange {
 public:
  Exchange() = default;
  ~Exchange() {
    delete given_.load();
    delete returned_.load();
  }
  Exchange(const Exchange&) = delete;
  Exchange& operator=(const Exchange&) = delete;

  /// Giver. A gift that was not taken yet is replaced.
  void give(std::unique_ptr<T> gift) {
    delete given_.exchange(gift.release());
    delete returned_.exchange(nullptr);
  }

  /// Taker. @return whether its own is another now
  bool take(T& own) {
    if (given_.load(std::memory_order_relaxed) == nullptr ||
        returned_.load(std::memory_order_relaxed) != nullptr) {
      return false;
    }
    T* gift = given_.exchange(nullptr, std::memory_order_acquire);
    if (gift == nullptr) {
      return false;
    }
    std::swap(own, *gift);
    returned_.store(gift, std::memory_order_release);
    return true;
  }

 private:
  std::atomic<T*> given_{nullptr};
  std::atomic<T*> returned_{nullptr};
};

}  // namespace kolsky

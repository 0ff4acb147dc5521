#pragma once

#include <functional>
#include <thread>

namespace kolsky {

/// A thread of the daemon under a name that `top` shows. What escapes its work is a fault of this
/// program that no other part can make good: it is said under that name and the process ends at
/// once with 1, so that whoever watches over it starts it anew, and journals give back what was in
/// hand.
class Thread {
 public:
  Thread() = default;
  /// @param name  a literal of at most 15 characters
  Thread(const char* name, std::function<void()> work);

  /// ... and not waited for yet.
  [[nodiscard]] bool begun() const { return thread_.joinable(); }
  /// Nothing to wait for is no error.
  void join();

 private:
  std::thread thread_;
};

}  // namespace kolsky

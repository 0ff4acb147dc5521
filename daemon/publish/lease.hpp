#pragma once

#include <chrono>
#include <string>

namespace kolsky {

/// Who may change what the daemon does: one client at a time, until it gives the lease back or has
/// been silent for too long. The caller says what time it is.
class Lease {
 public:
  using Clock = std::chrono::steady_clock;

  explicit Lease(Clock::duration silence) : silence_(silence) {}

  /// Empty if nobody.
  [[nodiscard]] std::string holder(Clock::time_point now) const {
    return now - last_heard_ < silence_ ? holder_ : std::string();
  }

  /// Takes it unless another client holds it. @return whether the client holds it now
  bool take(const std::string& client, Clock::time_point now) {
    const std::string held_by = holder(now);
    if (!held_by.empty() && held_by != client) {
      return false;
    }
    holder_ = client;
    last_heard_ = now;
    return true;
  }

  /// A client showed that it lives. Nothing happens unless it is the holder.
  void heard_from(const std::string& client, Clock::time_point now) {
    if (holder(now) == client) {
      last_heard_ = now;
    }
  }

  void release(const std::string& client) {
    if (holder_ == client) {
      holder_.clear();
    }
  }

 private:
  Clock::duration silence_;
  std::string holder_;
  Clock::time_point last_heard_{};
};

}  // namespace kolsky

#pragma once

#include <chrono>
#include <mutex>
#include <string>

namespace kolsky::cli {

/// Tells on stderr what a command is at, once it takes longer than a person likes to wait, and now
/// and then in a log. From however many threads.
class SlowWork {
 public:
  explicit SlowWork(std::string command);
  /// @param every  told no oftener than that
  SlowWork(std::string command, std::chrono::milliseconds every);

  void at(const std::string& step);

 private:
  using Clock = std::chrono::steady_clock;

  std::string command_;
  std::chrono::milliseconds every_;
  std::mutex lock_;
  Clock::time_point told_ = Clock::now();
};

}  // namespace kolsky::cli

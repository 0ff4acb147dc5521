#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace kolsky {

/// Sees that threads get on. Each gives a counter that moves while it works, and says whether it
/// has work.
class ThreadWatch {
 public:
  struct Pulse {
    std::uint64_t progress = 0;
    bool has_work = true;
  };

  /// @param patience  how long the counter may stand still while there is work
  void add(std::string name, std::chrono::milliseconds patience, std::function<Pulse()> pulse);

  /// Looks at every thread. @return the name of one that has stood still for too long
  [[nodiscard]] std::optional<std::string> find_stuck(std::chrono::steady_clock::time_point now);

 private:
  struct Watched {
    std::string name;
    std::chrono::milliseconds patience;
    std::function<Pulse()> pulse;
    std::uint64_t last_progress = 0;
    std::chrono::steady_clock::time_point last_change{};
    bool seen = false;
  };
  std::vector<Watched> threads_;
};

}  // namespace kolsky

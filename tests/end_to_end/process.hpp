#pragma once

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace kolsky::scene {

/// A program run beside the test; killed with it. Both its outputs go to one file.
class Process {
 public:
  /// @param environment  added to the test's own, as "NAME=value"
  Process(const std::vector<std::string>& command, const std::filesystem::path& output,
          const std::vector<std::string>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void signal(int number) const;
  /// Waits for its end. @return the exit code, 128 + signal, or nothing if it still runs
  std::optional<int> wait(std::chrono::milliseconds patience);
  [[nodiscard]] bool running() { return !wait(std::chrono::milliseconds(0)); }
  /// Processor time that it has used so far, of all its threads. @pre it runs
  [[nodiscard]] double cpu_s() const;
  /// What it has written so far.
  [[nodiscard]] std::string output() const;

 private:
  std::filesystem::path output_;
  pid_t pid_ = -1;
  std::optional<int> code_;
};

}  // namespace kolsky::scene

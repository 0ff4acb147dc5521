#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/end_to_end/process.hpp"
#include "tests/end_to_end/scene.hpp"

namespace kolsky::scene {

/// A kolskyd with its client.
class DaemonProcess {
 public:
  /// Starts it and waits until it serves. @throws std::runtime_error with its output where it does
  /// not
  explicit DaemonProcess(const Installation& installation,
                         const std::vector<std::string>& environment = {});

  [[nodiscard]] Process& process() { return process_; }
  [[nodiscard]] Listener& listener() { return *listener_; }
  [[nodiscard]] const EndpointConfig& endpoints() const { return endpoints_; }

 private:
  Process process_;
  EndpointConfig endpoints_;
  std::optional<Listener> listener_;
};

/// The command line of kolskyd.
[[nodiscard]] std::vector<std::string> kolskyd(const std::vector<std::string>& arguments);

}  // namespace kolsky::scene

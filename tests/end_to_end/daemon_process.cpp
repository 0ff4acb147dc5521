#include "tests/end_to_end/daemon_process.hpp"

#include <stdexcept>

namespace kolsky::scene {

namespace {

/// The endpoint that the log names behind a word; empty as long as its line is not there.
std::string endpoint_in(const std::string& log, const std::string& word) {
  const std::size_t at = log.find(word + " tcp://");
  if (at == std::string::npos) {
    return "";
  }
  const std::size_t begin = at + word.size() + 1;
  const std::size_t end = log.find_first_of(",\n", begin);
  return end == std::string::npos ? "" : log.substr(begin, end - begin);
}

EndpointConfig endpoints_of(Process& process) {
  EndpointConfig endpoints;
  const bool serves = eventually([&] {
    const std::string log = process.output();
    endpoints = {.results = endpoint_in(log, "results"),
                 .preview = endpoint_in(log, "preview"),
                 .control = endpoint_in(log, "control")};
    return !endpoints.control.empty() || !process.running();
  });
  if (!serves || endpoints.control.empty()) {
    throw std::runtime_error("kolskyd does not serve:\n" + process.output());
  }
  return endpoints;
}

}  // namespace

DaemonProcess::DaemonProcess(const Installation& installation,
                             const std::vector<std::string>& environment)
    : process_(kolskyd({"--config", (installation.folder() / "kolskyd.toml").string()}),
               installation.folder() / "output", environment),
      endpoints_(endpoints_of(process_)) {
  listener_.emplace(endpoints_);
}

std::vector<std::string> kolskyd(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{KOLSKYD};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace kolsky::scene

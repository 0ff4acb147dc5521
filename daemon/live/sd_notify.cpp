#include "daemon/live/sd_notify.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>

namespace kolsky {

namespace {

const char* environment(const char* name) noexcept {
  return std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing here sets the environment
}

}  // namespace

void sd_notify(const std::string& message) noexcept {
  const char* path = environment("NOTIFY_SOCKET");
  sockaddr_un address{};
  if (path == nullptr || (path[0] != '/' && path[0] != '@') ||
      std::strlen(path) >= sizeof(address.sun_path)) {
    return;
  }
  address.sun_family = AF_UNIX;
  std::memcpy(address.sun_path, path, std::strlen(path));
  if (path[0] == '@') {
    address.sun_path[0] = '\0';  // an abstract socket
  }
  const int socket_fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket_fd < 0) {
    return;
  }
  const auto length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + std::strlen(path));
  sendto(socket_fd, message.data(), message.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
         reinterpret_cast<const sockaddr*>(&address), length);
  close(socket_fd);
}

std::uint64_t watchdog_interval_us() noexcept {
  const char* pid = environment("WATCHDOG_PID");
  if (pid != nullptr && std::strtoll(pid, nullptr, 10) != getpid()) {
    return 0;
  }
  const char* interval = environment("WATCHDOG_USEC");
  return interval == nullptr ? 0 : std::strtoull(interval, nullptr, 10);
}

}  // namespace kolsky

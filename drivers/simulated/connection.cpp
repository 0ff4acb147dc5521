#include "drivers/simulated/connection.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <ctime>

namespace kolsky {

namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kReceiveBytes = 4096;

enum class Wait { ready, timeout, over };

timespec until(std::chrono::steady_clock::time_point time) {
  const auto left = std::max(time - std::chrono::steady_clock::now(),
                             std::chrono::steady_clock::duration::zero());
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(left);
  timespec span{};
  span.tv_sec = whole.count();
  span.tv_nsec = std::chrono::duration_cast<std::chrono::nanoseconds>(left - whole).count();
  return span;
}

/// Waits for any of the events, the time, the server's stop or the client's leaving.
Wait wait_for(int socket, int stop_fd, short events,
              std::optional<std::chrono::steady_clock::time_point> time) {
  for (;;) {
    pollfd watched[2] = {{socket, static_cast<short>(events | POLLRDHUP), 0}, {stop_fd, POLLIN, 0}};
    timespec span{};
    if (time) {
      span = until(*time);
    }
    const int count = ppoll(watched, 2, time ? &span : nullptr, nullptr);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count < 0 || watched[1].revents != 0) {
      return Wait::over;
    }
    if ((watched[0].revents & POLLIN) != 0 && (events & POLLIN) != 0) {
      return Wait::ready;  // what the client sent before it left still counts
    }
    if ((watched[0].revents & (POLLRDHUP | POLLHUP | POLLERR | POLLNVAL)) != 0) {
      return Wait::over;
    }
    if (count == 0) {
      return Wait::timeout;
    }
    return Wait::ready;
  }
}

}  // namespace

Connection::Connection(int socket, int stop_fd) : socket_(socket), stop_fd_(stop_fd) {}

Connection::~Connection() {
  close(socket_);
}

bool Connection::fill() {
  char bytes[kReceiveBytes];
  for (;;) {
    const ssize_t count = recv(socket_, bytes, sizeof bytes, 0);
    if (count > 0) {
      received_.append(bytes, static_cast<std::size_t>(count));
      return true;
    }
    if (count == 0) {
      return false;
    }
    if (errno == EINTR) {
      continue;
    }
    if (errno != EAGAIN && errno != EWOULDBLOCK) {
      return false;
    }
    if (wait_for(socket_, stop_fd_, POLLIN, std::nullopt) != Wait::ready) {
      return false;
    }
  }
}

std::optional<std::string> Connection::read_line() {
  std::size_t searched = 0;
  for (;;) {
    const std::size_t end = received_.find('\n', searched);
    if (end != std::string::npos) {
      std::string line = received_.substr(0, end);
      received_.erase(0, end + 1);
      if (!line.empty() && line.back() == '\r') {
        line.pop_back();
      }
      return line;
    }
    searched = received_.size();
    if (searched > kLongestLine || !fill()) {
      return std::nullopt;
    }
  }
}

bool Connection::read_bytes(std::size_t count, std::string& bytes) {
  while (received_.size() < count) {
    if (!fill()) {
      return false;
    }
  }
  bytes = received_.substr(0, count);
  received_.erase(0, count);
  return true;
}

bool Connection::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (count > 0) {
      bytes = bytes.subspan(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN || errno == EWOULDBLOCK) {
      if (wait_for(socket_, stop_fd_, POLLOUT, std::nullopt) != Wait::ready) {
        return false;
      }
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

bool Connection::write(std::string_view text) {
  return write(std::as_bytes(std::span(text.data(), text.size())));
}

bool Connection::wait_until(std::chrono::steady_clock::time_point time) {
  return wait_for(socket_, stop_fd_, 0, time) == Wait::timeout;
}

}  // namespace kolsky

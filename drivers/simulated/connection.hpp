#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace kolsky {

/// One client's socket: lines and bytes in, bytes out, each wait ended by the server's stop or by
/// the client's leaving. Owns the socket.
class Connection {
 public:
  /// @param socket   connected, non-blocking
  /// @param stop_fd  readable once the server stops
  Connection(int socket, int stop_fd);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// The next line without its end, or nothing if the connection is over. A line longer than any
  /// command ends it.
  [[nodiscard]] std::optional<std::string> read_line();

  /// Exactly so many bytes. @return false if the connection is over
  [[nodiscard]] bool read_bytes(std::size_t count, std::string& bytes);

  /// @return false if the connection is over
  [[nodiscard]] bool write(std::span<const std::byte> bytes);
  [[nodiscard]] bool write(std::string_view text);

  /// Waits until then. @return false if the connection is over
  [[nodiscard]] bool wait_until(std::chrono::steady_clock::time_point time);

 private:
  [[nodiscard]] bool fill();

  int socket_;
  int stop_fd_;
  std::string received_;
};

}  // namespace kolsky

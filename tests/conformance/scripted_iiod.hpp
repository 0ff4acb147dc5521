#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace kolsky {

/// One client's socket, as a script sees it.
class ScriptedClient {
 public:
  explicit ScriptedClient(int socket) : socket_(socket) {}
  ~ScriptedClient();
  ScriptedClient(const ScriptedClient&) = delete;
  ScriptedClient& operator=(const ScriptedClient&) = delete;

  /// Up to the line end, which is left out. @return false when the client has gone
  bool read_line(std::string& line);
  /// As many bytes as the string is long.
  bool read_exactly(std::string& bytes);
  bool send(std::string_view bytes);
  void hang_up();

 private:
  int socket_;
};

/// How a scripted device shows itself and what it answers.
struct ScriptedDevice {
  struct Channel {
    std::string id;
    std::string format = "le:s16/16>>0";
    std::vector<std::string> attributes{"scale"};
  };
  std::vector<Channel> channels{{"voltage0"}, {"voltage1"}};
  std::vector<std::string> device_attributes{"sampling_frequency"};
  std::vector<std::string> debug_attributes;
  /// Texts by "attribute", "channel/attribute" or "DEBUG/attribute".
  std::map<std::string, std::string> texts{
      {"sampling_frequency", "1000000"}, {"voltage0/scale", "0.5"}, {"voltage1/scale", "0.5"}};
  bool writable = true;     ///< else writes are answered with EPERM
  bool sticks = true;       ///< else what is written is forgotten
  int breaks_on_poll = -1;  ///< the read of a debug attribute, from 0, that ends the connection
  std::chrono::milliseconds trickle{0};  ///< the description is sent a byte each so often

  [[nodiscard]] std::string xml() const;
};

/// An IIOD that says just what a test wants said: for faults that a proper server does not have.
class ScriptedIiod {
 public:
  /// Answers one READBUF of so many bytes. @param call  counts them from 0, over all clients
  using ReadBuffer = std::function<void(ScriptedClient& client, std::size_t bytes, int call)>;

  ScriptedIiod(ScriptedDevice device, ReadBuffer read_buffer);
  ~ScriptedIiod();
  ScriptedIiod(const ScriptedIiod&) = delete;
  ScriptedIiod& operator=(const ScriptedIiod&) = delete;

  [[nodiscard]] std::string uri() const { return "ip:127.0.0.1:" + std::to_string(port_); }

  /// Every line that came, of all clients.
  [[nodiscard]] std::vector<std::string> lines() const;

  /// Waits until the server is being stopped, at most so long: for scripts that hang.
  void pause(std::chrono::milliseconds time) const;

 private:
  void accept_clients();
  void serve(ScriptedClient& client);
  bool describe(ScriptedClient& client) const;
  bool answer(ScriptedClient& client, const std::vector<std::string>& words);
  std::string read_attribute(const std::vector<std::string>& words);
  void write_attribute(const std::vector<std::string>& words, const std::string& value);

  ScriptedDevice device_;
  ReadBuffer read_buffer_;
  int listening_ = -1;
  std::uint16_t port_ = 0;
  std::atomic<bool> stop_{false};
  mutable std::mutex mutex_;
  std::vector<std::string> lines_;
  int calls_ = 0;
  int polls_ = 0;
  std::list<ScriptedClient> clients_;
  std::list<std::thread> threads_;
  std::thread acceptor_;
};

/// A READBUF's first chunk: its length, the mask and the bytes.
[[nodiscard]] std::string first_chunk(std::uint32_t mask, std::string_view bytes);

}  // namespace kolsky

#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/simulated/iiod_server.hpp"

namespace kolsky::testing {

/// A source whose codes say which sample of which channel they are, so that any slip shows.
class RampSource : public CodeSource {
 public:
  static constexpr Tick kShotSamples = 2000;
  static std::int32_t ramp(std::size_t channel, Tick tick) {
    return static_cast<std::int32_t>((tick * static_cast<Tick>(channel + 1)) % 20011) - 10000;
  }
  void convert(std::size_t channel, Tick first_tick, std::span<std::int32_t> codes) override {
    for (std::int32_t& code : codes) {
      code = ramp(channel, first_tick++);
    }
  }
  void fire(Tick tick) override { last_shot = tick; }
  [[nodiscard]] Tick shot_samples() const override { return kShotSamples; }
  void set_rate(SampleRate) override {}

  Tick last_shot = -1;
};

inline AdcSettings ramp_settings(double speed = 0.0, const std::string& faults = {}) {
  AdcSettings settings;
  settings.channels = {{"g1", 0.15, 0.0, 6e-8}, {"g2", 0.15, 3.0, 6e-8}};
  settings.rates = {{500'000, 1}, {1'000'000, 1}};
  settings.scenario = "ramp <&\">";
  settings.seed = 42;
  settings.speed = speed;
  std::istringstream script(faults);
  settings.faults = parse_fault_script(script, "faults");
  return settings;
}

/// A running server on a free port.
class ServedRamp {
 public:
  explicit ServedRamp(AdcSettings settings = ramp_settings())
      : adc(std::move(settings), std::make_unique<RampSource>()), server("127.0.0.1:0", adc) {
    server.start();
  }
  SimulatedAdc adc;
  IiodServer server;
};

/// A client that speaks the bytes of the protocol itself. Every wait ends after five seconds.
class RawClient {
 public:
  explicit RawClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int on = 1;
    setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    connected_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  explicit RawClient(const ServedRamp& served) : RawClient(served.server.port()) {}
  ~RawClient() { leave(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  void leave() {
    if (socket_ >= 0) {
      close(socket_);
      socket_ = -1;
    }
  }

  [[nodiscard]] bool connected() const { return connected_; }

  void send(const std::string& bytes) {
    (void)!::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  }

  /// The bytes, or fewer if the connection ended or nothing came in time.
  std::string receive(std::size_t count, std::chrono::milliseconds patience = kPatience) {
    std::string bytes;
    while (bytes.size() < count) {
      pollfd watched{socket_, POLLIN, 0};
      if (poll(&watched, 1, static_cast<int>(patience.count())) <= 0) {
        break;
      }
      char buffer[4096];
      const ssize_t got = recv(socket_, buffer, std::min(sizeof buffer, count - bytes.size()), 0);
      if (got <= 0) {
        over_ = true;
        break;
      }
      bytes.append(buffer, static_cast<std::size_t>(got));
    }
    return bytes;
  }

  std::string line(std::chrono::milliseconds patience = kPatience) {
    std::string text;
    for (std::string byte = receive(1, patience); !byte.empty() && byte != "\n";
         byte = receive(1, patience)) {
      text += byte;
    }
    return text;
  }

  /// Whether the server has ended the connection; waits for it.
  bool over() {
    while (!over_ && !receive(1).empty()) {
    }
    return over_;
  }

  std::string ask(const std::string& command) {
    send(command + "\r\n");
    return line();
  }

  /// An attribute's text, or the errno.
  std::string attribute(const std::string& name) {
    std::string length = ask("READ iio:device0 " + name);
    if (length.empty() || length.front() == '-') {
      return length;
    }
    const std::string payload = receive(std::stoul(length) + 1);
    return payload.substr(0, payload.find('\0'));
  }

  std::string write(const std::string& name, const std::string& value) {
    send("WRITE iio:device0 " + name + " " + std::to_string(value.size() + 1) + "\r\n");
    send(value + std::string(1, '\0'));
    return line();
  }

  std::uint32_t status() {
    write("DEBUG direct_reg_access", "2147483784");
    return static_cast<std::uint32_t>(
        std::stoul(attribute("DEBUG direct_reg_access"), nullptr, 16));
  }

 private:
  static constexpr std::chrono::milliseconds kPatience{5000};
  int socket_;
  bool connected_ = false;
  bool over_ = false;
};

/// A scan of both channels and the counter.
struct Scan {
  std::int16_t voltage[2];
  std::uint32_t count;
};
static_assert(sizeof(Scan) == 8);

/// What a READBUF was answered with.
struct BufferReply {
  long error = 0;  ///< 0, or the negative errno
  std::string mask;
  std::vector<std::size_t> chunks;
  std::string bytes;
  bool ended_short = false;  ///< by a 0

  [[nodiscard]] std::vector<Scan> scans() const {
    std::vector<Scan> result(bytes.size() / sizeof(Scan));
    std::memcpy(result.data(), bytes.data(), result.size() * sizeof(Scan));
    return result;
  }
};

inline BufferReply read_buffer(RawClient& client, std::size_t bytes) {
  BufferReply reply;
  client.send("READBUF iio:device0 " + std::to_string(bytes) + "\r\n");
  while (reply.bytes.size() < bytes) {
    const std::string head = client.line();
    const long count = head.empty() ? -1000 : std::stol(head);
    if (count <= 0) {
      reply.error = count;
      reply.ended_short = count == 0;
      return reply;
    }
    if (reply.mask.empty()) {
      reply.mask = client.line();
    }
    reply.chunks.push_back(static_cast<std::size_t>(count));
    reply.bytes += client.receive(static_cast<std::size_t>(count));
  }
  return reply;
}

}  // namespace kolsky::testing

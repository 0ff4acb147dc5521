// Any bytes on a connection to the IIOD server are answered or end it; nothing else happens.
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string_view>

#include "drivers/simulated/connection.hpp"
#include "drivers/simulated/iiod_command.hpp"
#include "drivers/simulated/session.hpp"

namespace {

using namespace kolsky;

class Silence : public CodeSource {
 public:
  void convert(std::size_t /*channel*/, Tick /*first_tick*/,
               std::span<std::int32_t> codes) override {
    std::fill(codes.begin(), codes.end(), 0);
  }
  void fire(Tick /*tick*/) override {}
  [[nodiscard]] Tick shot_samples() const override { return 100; }
  void set_rate(SampleRate /*rate*/) override {}
};

AdcSettings settings() {
  AdcSettings made;
  made.channels = {{"g1", 1.0, 0.0, 1e-6}, {"g2", 1.0, 0.0, 1e-6}};
  made.rates = {{500'000, 1}, {1'000'000, 1}};
  made.speed = 0.0;
  return made;
}

void require(bool holds) {
  if (!holds) {
    std::abort();
  }
}

}  // namespace

/// The bytes as one line of the protocol, then as all that a client sends before it closes its
/// side. It reads no reply, so a session that means to send much ends when the socket's buffer is
/// full.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const int error = parse_iiod_line(bytes.substr(0, bytes.find('\n'))).error;
  require(error == 0 || error == -EINVAL);

  static SimulatedAdc adc(settings(), std::make_unique<Silence>());
  static const int never = eventfd(0, EFD_NONBLOCK);
  int ends[2];
  require(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0);
  (void)!send(ends[0], data, size, MSG_NOSIGNAL);
  shutdown(ends[0], SHUT_WR);
  {
    Connection connection(ends[1], never);
    Session session(connection, adc, [](double) {});
    session.run();
  }
  close(ends[0]);
  return 0;
}

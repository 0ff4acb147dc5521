#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "drivers/simulated/simulated_adc.hpp"

namespace kolsky {

/// An IIOD server on TCP for one simulated converter: what libiio's `ip:` backend and the stock
/// tools talk to. Each connection has a thread of its own. Bad input on a connection is answered
/// with a negative errno or ends that connection, nothing else.
class IiodServer {
 public:
  /// @throws InputError where this is no address to listen on
  static void check_address(const std::string& listen);

  /// Binds and listens. @param listen  "address:port"; port 0 chooses a free one
  /// @throws InputError where the address is wrong or taken
  IiodServer(const std::string& listen, SimulatedAdc& adc);

  /// Stops.
  ~IiodServer();
  IiodServer(const IiodServer&) = delete;
  IiodServer& operator=(const IiodServer&) = delete;

  /// Accepts clients from now on, on a thread of its own.
  void start();

  /// Drops every client, closes the port and waits for the threads. Also when called twice.
  void stop();

  [[nodiscard]] std::uint16_t port() const noexcept;
  /// "ip:ADDRESS:PORT", for libiio.
  [[nodiscard]] std::string uri() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky

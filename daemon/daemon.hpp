#pragma once

#include <memory>
#include <string>

#include "daemon/config.hpp"

namespace kolsky {

/// The whole of kolskyd in one object, as `main` and tests run it.
class Daemon {
 public:
  /// Opens everything: the store is recovered, the sockets are bound, the digitiser is reached.
  /// @throws InputError for whatever is wrong
  explicit Daemon(const DaemonConfig& config);
  /// As `stop`.
  ~Daemon();
  Daemon(const Daemon&) = delete;
  Daemon& operator=(const Daemon&) = delete;

  /// Lets the samples in. A replay arms first.
  void start();
  /// Stops reading, stores what is in hand, closes the sockets.
  void stop();

  /// A client has asked for the end.
  [[nodiscard]] bool stop_requested() const;
  /// A replay is over and all its shots are stored and published.
  [[nodiscard]] bool finished() const;
  /// Whether the acquisition thread got the real-time priority it asked for.
  [[nodiscard]] bool real_time() const;

  /// Where the sockets are bound.
  [[nodiscard]] EndpointConfig endpoints() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace kolsky

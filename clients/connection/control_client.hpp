#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "proto/forward.hpp"
#include "proto/protocol.hpp"

namespace kolsky {

/// user@host: the same in every program of one person on one machine, so that `kolsky arm` and a
/// later `kolsky disarm` are one operator. KOLSKY_OPERATOR in the environment names another, as for
/// two people at one account.
[[nodiscard]] std::string default_client_id();

struct ControlClientOptions {
  std::string endpoint = wire::kDefaultControlEndpoint;
  std::string client_id = default_client_id();
  std::chrono::milliseconds timeout{2500};  ///< for one attempt
  int attempts = 3;
};

/// Asks the daemon. A request without an answer in time is sent again under the same id through a
/// fresh socket, so a lost reply never makes anything happen twice. Not to be used by two threads
/// at once. Everything throws InputError: no answer in time, an answer that is none, and (but for
/// `request`) a refusal, with the daemon's own words.
class ControlClient {
 public:
  explicit ControlClient(ControlClientOptions options);
  ~ControlClient();
  ControlClient(ControlClient&&) noexcept;
  ControlClient& operator=(ControlClient&&) noexcept;

  [[nodiscard]] v1::Status status();
  v1::Preflight arm();
  void disarm();
  void force_trigger();
  void fire();
  void reload();
  void stop();
  void release();
  /// Newest first. @param most 0: all
  [[nodiscard]] v1::ShotList list_shots(std::size_t most = 0);
  [[nodiscard]] v1::ShotAndResult get_shot(const std::string& id);
  [[nodiscard]] v1::Snapshot snapshot();

  /// Sends the command as it is, with id, client, version and boot filled in; a refusal is a reply
  /// like others, so an arm that fails its preflight can be shown check by check.
  [[nodiscard]] v1::ControlReply request(v1::ControlRequest command);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky

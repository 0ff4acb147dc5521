#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "proto/forward.hpp"
#include "proto/protocol.hpp"

namespace kolsky {

/// What the control server asks the daemon to do. Every function may throw: the client is told,
/// with the parts of an InputError kept. Must outlive the server.
class ControlHandler {
 public:
  ControlHandler() = default;
  virtual ~ControlHandler() = default;
  ControlHandler(const ControlHandler&) = delete;
  ControlHandler& operator=(const ControlHandler&) = delete;

  // In the server's own thread: must return within a few milliseconds. The reply's `operator_id`
  // and `boot_id` are filled in by the server.
  virtual void status(v1::Status& status) = 0;
  /// Publishes a status, then Publisher::snapshot.
  virtual void snapshot(v1::Snapshot& snapshot) = 0;

  // In the command thread, one after the other, in the order they came.
  /// Runs the preflight and arms. @throws InputError where a check fails; `preflight` is sent all
  /// the same
  virtual void arm(v1::Preflight& preflight) = 0;
  virtual void disarm() = 0;
  virtual void force_trigger() = 0;
  virtual void fire() = 0;
  virtual void reload() = 0;
  /// Asks the daemon to end. Must not destroy the server itself.
  virtual void stop() = 0;
  /// Begins; `diagnosis` says under which id. @throws InputError where none can begin
  virtual void diagnose(const v1::Diagnose& request, v1::Diagnosis& diagnosis);
  virtual void cancel_diagnosis();

  // In the reading thread, one after the other; as long as they need.
  virtual void list_shots(std::size_t most, v1::ShotList& shots) = 0;
  virtual void get_shot(const std::string& id, v1::ShotAndResult& shot) = 0;
  /// The diagnosis under way, or the last. @throws InputError where there is none
  virtual void diagnosis(v1::Diagnosis& diagnosis);
};

struct ControlServerOptions {
  std::string endpoint = wire::kDefaultControlEndpoint;
  std::uint64_t boot_id = 0;                  ///< the publisher's
  std::chrono::milliseconds lease{30'000};    ///< a holder silent for so long has lost it
  std::size_t remembered_replies = 1024;      ///< of commands, and as many of questions
  std::size_t remembered_bytes = 64U << 20U;  ///< of answers to questions
  std::size_t most_waiting = 64;              ///< per thread; more are refused as busy
};

/// Answers control requests in threads of its own. Each request id of a client is carried out at
/// most once: a repeated one gets the answer of the first, also while that is still under way.
/// Commands that change something take the lease for their client and are refused while another
/// holds it. Whatever bytes arrive, the answer is a reply with the reason.
class ControlServer {
 public:
  /// Binds and starts. Port "*" or 0 takes a free one. @throws InputError naming the endpoint
  ControlServer(const ControlServerOptions& options, ControlHandler& handler);
  /// Waits for what is being carried out, refuses what waits, sends the replies.
  ~ControlServer();
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  [[nodiscard]] const std::string& endpoint() const noexcept;
  /// Who holds the lease, empty if nobody. From any thread.
  [[nodiscard]] std::string operator_id() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky

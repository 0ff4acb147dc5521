#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "proto/forward.hpp"
#include "proto/protocol.hpp"

namespace kolsky {

struct PublisherOptions {
  std::string results_endpoint = wire::kDefaultResultsEndpoint;
  std::string preview_endpoint = wire::kDefaultPreviewEndpoint;
  /// Messages held for a slow subscriber before it loses the newest. ZeroMQ takes note of what was
  /// read once a millisecond: also a quick one loses when more than this many go out in less.
  int results_queue = 256;
  int preview_queue = 2;
};

/// Sends what happens to whoever listens. Every function may be called from any thread; none waits
/// for a subscriber: a slow or dead one loses messages, which it sees from the sequences. Each
/// topic counts from 1 without holes under one boot id. Keeps the last message of each topic for
/// late joiners.
class Publisher {
 public:
  /// Binds both sockets. Port "*" or 0 takes a free one.
  /// @throws InputError naming the endpoint that cannot be bound
  explicit Publisher(const PublisherOptions& options);
  ~Publisher();
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;

  /// Drawn anew at each construction, never 0.
  [[nodiscard]] std::uint64_t boot_id() const noexcept;
  /// Where the sockets are bound, with the port they got.
  [[nodiscard]] const std::string& results_endpoint() const noexcept;
  [[nodiscard]] const std::string& preview_endpoint() const noexcept;

  /// The heartbeat: the owner calls it each second and after every change. `boot_id` and
  /// `last_sequence` are filled in here. Like the others, gives the sequence it went out with.
  std::uint64_t publish_status(v1::Status status);
  std::uint64_t publish_shot(const v1::Shot& shot);
  std::uint64_t publish_result(const v1::Result& result);
  std::uint64_t publish_fault(const v1::Fault& fault);
  std::uint64_t publish_comparison(const v1::Comparison& comparison);
  std::uint64_t publish_diagnosis(const v1::Diagnosis& diagnosis);
  /// The preview may lose messages whatever the subscriber does; nobody keeps them.
  std::uint64_t publish_preview(const v1::Preview& preview);

  /// Fills the last of each results topic and the sequences they have, all of one moment. A
  /// subscriber that has received a status with a sequence up to the one in here misses nothing
  /// after the snapshot, so publish a status first: it then need not wait for the next heartbeat.
  void snapshot(v1::Snapshot& snapshot) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky

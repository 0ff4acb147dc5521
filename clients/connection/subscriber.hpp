#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "clients/connection/control_client.hpp"
#include "proto/forward.hpp"
#include "proto/protocol.hpp"

namespace kolsky {

/// A message as published. `payload` is read with wire::parse into the topic's message.
struct Received {
  std::string topic;
  std::uint64_t boot_id = 0;
  std::uint64_t sequence = 0;
  std::int64_t utc_ns = 0;  ///< when it was sent
  std::int64_t monotonic_ns = 0;
  std::string payload;
};

/// Messages of a topic that were published and will not come: `count` from `first_sequence` on.
struct Lost {
  std::string topic;
  std::uint64_t first_sequence = 0;
  std::uint64_t count = 0;
};

/// The daemon was started again; sequences count from 1 once more.
struct Restarted {
  std::uint64_t previous_boot_id = 0;
  std::uint64_t boot_id = 0;
};

/// Frames that are no message of a version known here.
struct Unreadable {
  std::string reason;
};

/// Nothing came in time.
struct Silence {};

using SubscriberEvent = std::variant<Received, Lost, Restarted, Unreadable, Silence>;

struct SubscriberOptions {
  std::string endpoint = wire::kDefaultResultsEndpoint;
  std::vector<std::string> topics{wire::kShotTopic,      wire::kResultTopic,
                                  wire::kFaultTopic,     wire::kComparisonTopic,
                                  wire::kDiagnosisTopic, wire::kStatusTopic};
  int receive_queue = 1000;  ///< messages held while the program does something else
};

/// Listens to one endpoint of the publisher, through its restarts. What was lost is said before
/// what came after it, also when nothing came after: each heartbeat names the last sequence of
/// every topic. Not to be used by two threads at once.
class Subscriber {
 public:
  /// Connects; the daemon need not be there yet. @throws InputError where the endpoint is none
  explicit Subscriber(const SubscriberOptions& options);
  ~Subscriber();
  Subscriber(Subscriber&&) noexcept;
  Subscriber& operator=(Subscriber&&) noexcept;

  [[nodiscard]] SubscriberEvent next(std::chrono::milliseconds timeout);

  /// For a late joiner: what has been, as one snapshot; `next` then goes on right behind it, each
  /// message once. Needs the status topic among those subscribed to.
  /// @throws InputError where the daemon does not answer in time
  [[nodiscard]] v1::Snapshot join(ControlClient& control, std::chrono::milliseconds timeout);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace kolsky

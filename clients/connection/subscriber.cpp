#include "clients/connection/subscriber.hpp"

#include <algorithm>
#include <cerrno>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <zmq.hpp>

#include "clients/connection/endpoint.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"
#include "proto/codec.hpp"

namespace kolsky {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kHeartbeat_ms = 10'000;  // finds a connection whose other end is gone without a word
constexpr int kHeartbeatTimeout_ms = 60'000;
constexpr int kReconnectMost_ms = 2'000;
constexpr milliseconds kFirstJoinRound{5};
constexpr milliseconds kLongestJoinRound{200};

std::vector<std::string> receive_frames(zmq::socket_t& socket, milliseconds timeout) {
  socket.set(zmq::sockopt::rcvtimeo, static_cast<int>(timeout.count()));
  std::vector<std::string> frames;
  zmq::message_t frame;
  try {
    do {
      if (!socket.recv(frame)) {
        return {};
      }
      frames.emplace_back(frame.data<char>(), frame.size());
    } while (frame.more());
  } catch (const zmq::error_t& error) {
    // A signal: the caller looks at what it wants, and calls again.
    if (error.num() != EINTR) {
      throw;
    }
    return {};
  }
  return frames;
}

std::variant<Received, Unreadable> read(std::vector<std::string> frames) {
  if (frames.size() != 3) {
    return Unreadable{std::to_string(frames.size()) +
                      " frames instead of topic, envelope, payload"};
  }
  v1::Envelope envelope;
  try {
    wire::parse(frames[1], "envelope of \"" + frames[0] + "\"", envelope);
  } catch (const InputError& error) {
    return Unreadable{error.what()};
  }
  if (envelope.schema_version() != wire::kSchemaVersion) {
    return Unreadable{"schema version " + std::to_string(envelope.schema_version()) +
                      " is not spoken here; use a client and a kolskyd of the same age"};
  }
  return Received{std::move(frames[0]), envelope.boot_id(),      envelope.sequence(),
                  envelope.utc_ns(),    envelope.monotonic_ns(), std::move(frames[2])};
}

/// Whether a message proves that the subscriptions stood before the snapshot was taken, so that
/// nothing falls between the two.
bool proves(const Received& message, const v1::Snapshot& snapshot) {
  const auto found = snapshot.last_sequence().find(wire::kStatusTopic);
  return message.topic == wire::kStatusTopic && message.boot_id == snapshot.boot_id() &&
         found != snapshot.last_sequence().end() && message.sequence <= found->second;
}

/// What has come of each topic, and so what has not.
class Continuity {
 public:
  explicit Continuity(const std::vector<std::string>& topics) : topics_(topics) {}

  /// What there is to say about a message, itself included unless it is old.
  void note(Received message, std::deque<SubscriberEvent>& events) {
    note_boot(message.boot_id, events);
    if (!note_sequence(message.topic, message.sequence, events)) {
      return;
    }
    if (message.topic == wire::kStatusTopic && !note_heartbeat(message, events)) {
      return;
    }
    events.emplace_back(std::move(message));
  }

  /// Everything up to these sequences is known.
  void start_after(const v1::Snapshot& snapshot) {
    boot_id_ = snapshot.boot_id();
    last_.clear();
    for (const std::string& topic : topics_) {
      const auto found = snapshot.last_sequence().find(topic);
      last_[topic] = found == snapshot.last_sequence().end() ? 0 : found->second;
    }
  }

 private:
  void note_boot(std::uint64_t boot_id, std::deque<SubscriberEvent>& events) {
    if (boot_id == boot_id_) {
      return;
    }
    if (boot_id_ != 0) {
      events.emplace_back(Restarted{boot_id_, boot_id});
      // Its messages before this one were sent while nobody here was connected.
      for (auto& [topic, sequence] : last_) {
        sequence = 0;
      }
    }
    boot_id_ = boot_id;
  }

  /// @return whether the message is new
  bool note_sequence(const std::string& topic, std::uint64_t sequence,
                     std::deque<SubscriberEvent>& events) {
    const auto found = last_.find(topic);
    if (found == last_.end()) {
      last_[topic] = sequence;
      return true;
    }
    if (sequence <= found->second) {
      return false;
    }
    note_reached(topic, found->second, sequence - 1, events);
    found->second = sequence;
    return true;
  }

  /// A heartbeat names what went out before it. Topics of which nothing was seen yet begin here.
  /// @return whether it can be read
  bool note_heartbeat(const Received& message, std::deque<SubscriberEvent>& events) {
    v1::Status status;
    try {
      wire::parse(message.payload, "status", status);
    } catch (const InputError& error) {
      events.emplace_back(Unreadable{error.what()});
      return false;
    }
    for (const std::string& topic : topics_) {
      const auto named = status.last_sequence().find(topic);
      if (named == status.last_sequence().end()) {
        continue;
      }
      const auto [known, is_new] = last_.try_emplace(topic, named->second);
      if (!is_new && named->second > known->second) {
        note_reached(topic, known->second, named->second, events);
        known->second = named->second;
      }
    }
    return true;
  }

  static void note_reached(const std::string& topic, std::uint64_t seen, std::uint64_t reached,
                           std::deque<SubscriberEvent>& events) {
    if (reached > seen) {
      events.emplace_back(Lost{topic, seen + 1, reached - seen});
    }
  }

  std::vector<std::string> topics_;
  std::uint64_t boot_id_ = 0;
  std::map<std::string, std::uint64_t> last_;
};

}  // namespace

struct Subscriber::State {
  explicit State(const SubscriberOptions& options)
      : endpoint(options.endpoint),
        topics(options.topics),
        socket(context, zmq::socket_type::sub),
        continuity(options.topics) {
    socket.set(zmq::sockopt::linger, 0);
    socket.set(zmq::sockopt::rcvhwm, options.receive_queue);
    socket.set(zmq::sockopt::heartbeat_ivl, kHeartbeat_ms);
    socket.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeout_ms);
    socket.set(zmq::sockopt::reconnect_ivl_max, kReconnectMost_ms);
    // The status topic last: its first message proves that the other subscriptions have arrived.
    std::stable_partition(topics.begin(), topics.end(),
                          [](const std::string& topic) { return topic != wire::kStatusTopic; });
    for (const std::string& topic : topics) {
      socket.set(zmq::sockopt::subscribe, topic);
    }
    connect_socket(socket, endpoint);
  }

  bool take_one(milliseconds timeout);
  bool hear_proof(const v1::Snapshot& snapshot, milliseconds round,
                  std::vector<Received>& messages);
  void start_after(const v1::Snapshot& snapshot, std::vector<Received> messages);

  std::string endpoint;
  std::vector<std::string> topics;
  zmq::context_t context{1};
  zmq::socket_t socket;
  Continuity continuity;
  std::deque<SubscriberEvent> events;  ///< found, not handed out yet
};

/// @return whether anything came
bool Subscriber::State::take_one(milliseconds timeout) {
  std::vector<std::string> frames = receive_frames(socket, timeout);
  if (frames.empty()) {
    return false;
  }
  auto message = read(std::move(frames));
  if (auto* received = std::get_if<Received>(&message)) {
    continuity.note(std::move(*received), events);
  } else {
    events.emplace_back(std::get<Unreadable>(std::move(message)));
  }
  return true;
}

/// Collects messages until one proves the snapshot, or shows that only a later snapshot can be
/// proven.
/// @param messages  collected so far in this join
bool Subscriber::State::hear_proof(const v1::Snapshot& snapshot, milliseconds round,
                                   std::vector<Received>& messages) {
  const auto is_proof = [&](const Received& message) { return proves(message, snapshot); };
  if (std::ranges::any_of(messages, is_proof)) {
    return true;
  }
  const auto until = Clock::now() + round;
  for (auto left = round; left.count() > 0;
       left = std::chrono::ceil<milliseconds>(until - Clock::now())) {
    std::vector<std::string> frames = receive_frames(socket, left);
    if (frames.empty()) {
      continue;
    }
    auto message = read(std::move(frames));
    if (auto* unreadable = std::get_if<Unreadable>(&message)) {
      events.emplace_back(std::move(*unreadable));
      continue;
    }
    messages.push_back(std::get<Received>(std::move(message)));
    if (messages.back().topic == wire::kStatusTopic) {
      return is_proof(messages.back());
    }
  }
  return false;
}

void Subscriber::State::start_after(const v1::Snapshot& snapshot, std::vector<Received> messages) {
  continuity.start_after(snapshot);
  // Messages of a daemon before the snapshot's are part of no story that goes on.
  const auto first = std::ranges::find(messages, snapshot.boot_id(), &Received::boot_id);
  for (auto message = first; message != messages.end(); ++message) {
    continuity.note(std::move(*message), events);
  }
}

Subscriber::Subscriber(const SubscriberOptions& options)
    : state_(std::make_unique<State>(options)) {}
Subscriber::~Subscriber() = default;
Subscriber::Subscriber(Subscriber&&) noexcept = default;
Subscriber& Subscriber::operator=(Subscriber&&) noexcept = default;

SubscriberEvent Subscriber::next(milliseconds timeout) {
  const auto until = Clock::now() + timeout;
  while (state_->events.empty()) {
    const auto left = std::chrono::ceil<milliseconds>(until - Clock::now());
    if (!state_->take_one(std::max(left, milliseconds{0}))) {
      return Silence{};
    }
  }
  SubscriberEvent event = std::move(state_->events.front());
  state_->events.pop_front();
  return event;
}

v1::Snapshot Subscriber::join(ControlClient& control, milliseconds timeout) {
  if (std::ranges::find(state_->topics, wire::kStatusTopic) == state_->topics.end()) {
    throw InputError("topics", "joining needs the status topic", "subscribe to it as well");
  }
  state_->events.clear();
  std::vector<Received> messages;
  const auto until = Clock::now() + timeout;
  for (milliseconds round = kFirstJoinRound; Clock::now() < until;
       round = std::min(2 * round, kLongestJoinRound)) {
    v1::Snapshot snapshot = control.snapshot();
    if (state_->hear_proof(snapshot, round, messages)) {
      state_->start_after(snapshot, std::move(messages));
      return snapshot;
    }
  }
  throw InputError("results endpoint " + state_->endpoint,
                   "no heartbeat of the kolskyd that answers control requests arrives",
                   "give the results endpoint of the same kolskyd");
}

}  // namespace kolsky

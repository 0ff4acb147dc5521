#include "daemon/publish/publisher.hpp"

#include <time.h>

#include <map>
#include <mutex>
#include <random>
#include <zmq.hpp>

#include "daemon/publish/bind.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "proto/codec.hpp"
#include "proto/text.hpp"

namespace kolsky {
namespace {

using Payload = std::shared_ptr<const std::string>;

constexpr int kHeartbeat_ms = 10'000;
constexpr int kHeartbeatTimeout_ms = 60'000;  // then a dead subscriber's queue is freed
constexpr int kLinger_ms = 200;  // for the last words; nobody holds the close up longer
constexpr std::int64_t kMaxSubscriptionBytes = 4096;

std::int64_t now_ns(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

std::uint64_t draw_boot_id() {
  std::random_device random;
  std::uint64_t id = 0;
  while (id == 0) {
    id = (static_cast<std::uint64_t>(random()) << 32U) | random();
  }
  return id;
}

Payload payload_of(const google::protobuf::Message& message) {
  return std::make_shared<const std::string>(wire::serialise(message));
}

/// A frame that shares the payload instead of copying it, however many subscribers there are.
zmq::message_t frame_of(const Payload& payload) {
  auto* owner = new Payload(payload);
  // ZeroMQ only reads what it is given, though its interface does not say const.
  return {const_cast<char*>(payload->data()), payload->size(),
          [](void* /*data*/, void* hint) { delete static_cast<Payload*>(hint); }, owner};
}

struct Topic {
  std::uint64_t sequence = 0;
  Payload last;
};

/// One PUB socket and the topics on it. Whoever uses it holds the mutex.
class Outlet {
 public:
  Outlet(zmq::context_t& context, const std::string& setting, const std::string& endpoint,
         int queue, int linger_ms)
      : socket_(context, zmq::socket_type::pub) {
    socket_.set(zmq::sockopt::sndhwm, queue);
    socket_.set(zmq::sockopt::linger, linger_ms);
    socket_.set(zmq::sockopt::heartbeat_ivl, kHeartbeat_ms);
    socket_.set(zmq::sockopt::heartbeat_timeout, kHeartbeatTimeout_ms);
    socket_.set(zmq::sockopt::maxmsgsize, kMaxSubscriptionBytes);
    endpoint_ = bind_socket(socket_, setting, endpoint);
  }

  [[nodiscard]] std::mutex& mutex() const { return mutex_; }
  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  [[nodiscard]] const std::map<std::string, Topic>& topics() const { return topics_; }
  Topic& topic(const std::string& name) { return topics_[name]; }

  /// PUB never waits: a subscriber whose queue is full is skipped.
  void send(const std::string& topic, const std::string& envelope, const Payload& payload) {
    constexpr auto kMore = zmq::send_flags::sndmore | zmq::send_flags::dontwait;
    static_cast<void>(socket_.send(zmq::buffer(topic), kMore));
    static_cast<void>(socket_.send(zmq::buffer(envelope), kMore));
    static_cast<void>(socket_.send(frame_of(payload), zmq::send_flags::dontwait));
  }

 private:
  mutable std::mutex mutex_;
  zmq::socket_t socket_;
  std::string endpoint_;
  std::map<std::string, Topic> topics_;
};

template <class Map>
void fill_sequences(const Outlet& outlet, Map& sequences) {
  sequences.clear();
  for (const auto& [name, topic] : outlet.topics()) {
    sequences[name] = topic.sequence;
  }
}

}  // namespace

struct Publisher::State {
  explicit State(const PublisherOptions& options)
      : results(context, "endpoints.results", options.results_endpoint, options.results_queue,
                kLinger_ms),
        preview(context, "endpoints.preview", options.preview_endpoint, options.preview_queue, 0) {
    for (const char* name : {wire::kStatusTopic, wire::kShotTopic, wire::kResultTopic,
                             wire::kFaultTopic, wire::kComparisonTopic, wire::kDiagnosisTopic}) {
      results.topic(name);
    }
  }

  /// @pre the outlet's mutex is held
  std::uint64_t send_locked(Outlet& outlet, const std::string& name, Payload payload) {
    Topic& topic = outlet.topic(name);
    v1::Envelope envelope;
    envelope.set_schema_version(wire::kSchemaVersion);
    envelope.set_boot_id(boot_id);
    envelope.set_sequence(++topic.sequence);
    envelope.set_utc_ns(now_ns(CLOCK_REALTIME));
    envelope.set_monotonic_ns(now_ns(CLOCK_MONOTONIC));
    outlet.send(name, envelope.SerializeAsString(), payload);
    topic.last = std::move(payload);
    return topic.sequence;
  }

  std::uint64_t send(Outlet& outlet, const char* name, const google::protobuf::Message& message) {
    Payload payload = payload_of(message);
    const std::lock_guard lock(outlet.mutex());
    return send_locked(outlet, name, std::move(payload));
  }

  std::uint64_t boot_id = draw_boot_id();
  zmq::context_t context{1};
  Outlet results;
  Outlet preview;
};

Publisher::Publisher(const PublisherOptions& options) : state_(std::make_unique<State>(options)) {}
Publisher::~Publisher() = default;

std::uint64_t Publisher::boot_id() const noexcept {
  return state_->boot_id;
}
const std::string& Publisher::results_endpoint() const noexcept {
  return state_->results.endpoint();
}
const std::string& Publisher::preview_endpoint() const noexcept {
  return state_->preview.endpoint();
}

std::uint64_t Publisher::publish_status(v1::Status status) {
  status.set_boot_id(state_->boot_id);
  Outlet& outlet = state_->results;
  // Under one lock, so that a status never names a message that went out after it.
  const std::lock_guard lock(outlet.mutex());
  auto& sequences = *status.mutable_last_sequence();
  fill_sequences(outlet, sequences);
  ++sequences[wire::kStatusTopic];
  return state_->send_locked(outlet, wire::kStatusTopic, payload_of(status));
}

std::uint64_t Publisher::publish_shot(const v1::Shot& shot) {
  return state_->send(state_->results, wire::kShotTopic, shot);
}

std::uint64_t Publisher::publish_result(const v1::Result& result) {
  return state_->send(state_->results, wire::kResultTopic, result);
}

std::uint64_t Publisher::publish_fault(const v1::Fault& fault) {
  return state_->send(state_->results, wire::kFaultTopic, fault);
}

std::uint64_t Publisher::publish_comparison(const v1::Comparison& comparison) {
  return state_->send(state_->results, wire::kComparisonTopic, comparison);
}

std::uint64_t Publisher::publish_diagnosis(const v1::Diagnosis& diagnosis) {
  return state_->send(state_->results, wire::kDiagnosisTopic, diagnosis);
}

std::uint64_t Publisher::publish_preview(const v1::Preview& preview) {
  return state_->send(state_->preview, wire::kPreviewTopic, preview);
}

void Publisher::snapshot(v1::Snapshot& snapshot) const {
  snapshot.Clear();
  snapshot.set_boot_id(state_->boot_id);
  std::map<std::string, Topic> topics;
  {
    const std::lock_guard lock(state_->results.mutex());
    fill_sequences(state_->results, *snapshot.mutable_last_sequence());
    topics = state_->results.topics();
  }
  const auto restore = [&topics](const char* name, auto make_field) {
    if (const Payload& last = topics[name].last) {
      wire::parse(*last, name, *make_field());
    }
  };
  restore(wire::kStatusTopic, [&] { return snapshot.mutable_status(); });
  restore(wire::kShotTopic, [&] { return snapshot.mutable_last_shot(); });
  restore(wire::kResultTopic, [&] { return snapshot.mutable_last_result(); });
  restore(wire::kFaultTopic, [&] { return snapshot.mutable_last_fault(); });
  restore(wire::kComparisonTopic, [&] { return snapshot.mutable_last_comparison(); });
  restore(wire::kDiagnosisTopic, [&] { return snapshot.mutable_last_diagnosis(); });
}

}  // namespace kolsky

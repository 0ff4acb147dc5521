#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "clients/connection/subscriber.hpp"
#include "daemon/publish/control_server.hpp"
#include "daemon/publish/publisher.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

PublisherOptions on_free_ports() {
  PublisherOptions options;
  options.results_endpoint = "tcp://127.0.0.1:*";
  options.preview_endpoint = "tcp://127.0.0.1:*";
  options.results_queue = 100'000;
  return options;
}

/// The part of a daemon that publishes and answers `snapshot`.
class LittleDaemon : public ControlHandler {
 public:
  enum class OnSnapshot { publishes_status, waits_for_heartbeat };

  explicit LittleDaemon(OnSnapshot on_snapshot)
      : on_snapshot_(on_snapshot), publisher(on_free_ports()), server(server_options(), *this) {}

  void snapshot(v1::Snapshot& snapshot) override {
    if (on_snapshot_ == OnSnapshot::publishes_status) {
      publisher.publish_status({});
    }
    publisher.snapshot(snapshot);
  }
  void status(v1::Status& /*status*/) override {}
  void arm(v1::Preflight& /*preflight*/) override {}
  void disarm() override {}
  void force_trigger() override {}
  void fire() override {}
  void reload() override {}
  void stop() override {}
  void list_shots(std::size_t /*most*/, v1::ShotList& /*shots*/) override {}
  void get_shot(const std::string& /*id*/, v1::ShotAndResult& /*shot*/) override {}

 private:
  [[nodiscard]] ControlServerOptions server_options() const {
    ControlServerOptions options;
    options.endpoint = "tcp://127.0.0.1:*";
    options.boot_id = publisher.boot_id();
    return options;
  }

  OnSnapshot on_snapshot_;

 public:
  Publisher publisher;
  ControlServer server;
};

ControlClient client_of(const LittleDaemon& daemon) {
  ControlClientOptions options;
  options.endpoint = daemon.server.endpoint();
  return ControlClient(options);
}

Subscriber subscriber_of(const std::string& endpoint) {
  SubscriberOptions options;
  options.endpoint = endpoint;
  options.receive_queue = 100'000;
  return Subscriber(options);
}

/// Publishes shots named 1, 2, 3, ... and heartbeats, as fast as told, until it goes.
class BusyHours {
 public:
  BusyHours(Publisher& publisher, std::chrono::microseconds pause, int shots_per_heartbeat)
      : thread_([this, &publisher, pause, shots_per_heartbeat] {
          for (std::uint64_t shot = 1; !over_; ++shot) {
            v1::Shot message;
            message.set_id(std::to_string(shot));
            publisher.publish_shot(message);
            if (shot % shots_per_heartbeat == 0) {
              publisher.publish_status({});
            }
            std::this_thread::sleep_for(pause);
          }
        }) {}
  ~BusyHours() {
    over_ = true;
    thread_.join();
  }
  BusyHours(const BusyHours&) = delete;
  BusyHours& operator=(const BusyHours&) = delete;

 private:
  std::atomic<bool> over_ = false;
  std::thread thread_;
};

std::uint64_t shot_number(const Received& received) {
  v1::Shot shot;
  EXPECT_TRUE(shot.ParseFromString(received.payload));
  return std::stoull(shot.id());
}

/// What follows a snapshot, up to so many shots: each once, in order, none left out.
void expect_all_after(const v1::Snapshot& snapshot, Subscriber& subscriber, int shots) {
  std::uint64_t expected =
      snapshot.last_shot().id().empty() ? 1 : std::stoull(snapshot.last_shot().id()) + 1;
  for (int seen = 0; seen < shots;) {
    const SubscriberEvent event = subscriber.next(5000ms);
    const auto* received = std::get_if<Received>(&event);
    ASSERT_NE(received, nullptr) << "event " << event.index() << " before shot " << expected;
    if (received->topic == "shot") {
      ASSERT_EQ(shot_number(*received), expected);
      ++expected;
      ++seen;
    }
  }
}

TEST(LateJoiner, GetsEverythingExactlyOnce) {
  LittleDaemon daemon(LittleDaemon::OnSnapshot::publishes_status);
  const BusyHours busy(daemon.publisher, 50us, 1000);
  for (int joiner = 0; joiner < 20; ++joiner) {
    ControlClient control = client_of(daemon);
    Subscriber subscriber = subscriber_of(daemon.publisher.results_endpoint());
    const v1::Snapshot snapshot = subscriber.join(control, 5000ms);
    EXPECT_EQ(snapshot.boot_id(), daemon.publisher.boot_id());
    expect_all_after(snapshot, subscriber, 100);
  }
}

TEST(LateJoiner, GetsEverythingExactlyOnceFromADaemonThatOnlyHasHeartbeats) {
  LittleDaemon daemon(LittleDaemon::OnSnapshot::waits_for_heartbeat);
  const BusyHours busy(daemon.publisher, 200us, 50);
  for (int joiner = 0; joiner < 5; ++joiner) {
    ControlClient control = client_of(daemon);
    Subscriber subscriber = subscriber_of(daemon.publisher.results_endpoint());
    expect_all_after(subscriber.join(control, 5000ms), subscriber, 100);
  }
}

TEST(LateJoiner, JoiningAgainGoesOnWithoutDoubles) {
  LittleDaemon daemon(LittleDaemon::OnSnapshot::publishes_status);
  const BusyHours busy(daemon.publisher, 100us, 1000);
  ControlClient control = client_of(daemon);
  Subscriber subscriber = subscriber_of(daemon.publisher.results_endpoint());
  for (int i = 0; i < 5; ++i) {
    expect_all_after(subscriber.join(control, 5000ms), subscriber, 50);
  }
}

TEST(LateJoiner, IsQuickWithAQuietDaemon) {
  LittleDaemon daemon(LittleDaemon::OnSnapshot::publishes_status);
  v1::Shot shot;
  shot.set_id("1");
  daemon.publisher.publish_shot(shot);
  ControlClient control = client_of(daemon);
  Subscriber subscriber = subscriber_of(daemon.publisher.results_endpoint());
  const auto start = Clock::now();
  const v1::Snapshot snapshot = subscriber.join(control, 5000ms);
  RecordProperty("join_ms", static_cast<int>((Clock::now() - start) / 1ms));
  EXPECT_EQ(snapshot.last_shot().id(), "1");
  // The only shot there was does not come again.
  SubscriberEvent event = subscriber.next(50ms);
  while (const auto* received = std::get_if<Received>(&event)) {
    EXPECT_EQ(received->topic, "status");
    event = subscriber.next(50ms);
  }
  EXPECT_TRUE(std::holds_alternative<Silence>(event));
}

TEST(LateJoiner, ResultsAndControlOfTwoDaemonsAreTold) {
  LittleDaemon answering(LittleDaemon::OnSnapshot::publishes_status);
  LittleDaemon publishing(LittleDaemon::OnSnapshot::publishes_status);
  const BusyHours busy(publishing.publisher, 1000us, 10);
  ControlClient control = client_of(answering);
  Subscriber subscriber = subscriber_of(publishing.publisher.results_endpoint());
  EXPECT_THROW(static_cast<void>(subscriber.join(control, 300ms)), InputError);
}

TEST(LateJoiner, NeedsTheStatusTopic) {
  LittleDaemon daemon(LittleDaemon::OnSnapshot::publishes_status);
  ControlClient control = client_of(daemon);
  SubscriberOptions options;
  options.endpoint = daemon.publisher.results_endpoint();
  options.topics = {"shot"};
  Subscriber subscriber(options);
  EXPECT_THROW(static_cast<void>(subscriber.join(control, 300ms)), InputError);
}

}  // namespace
}  // namespace kolsky

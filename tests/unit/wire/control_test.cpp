#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <zmq.hpp>
#include <zmq_addon.hpp>

#include "clients/connection/control_client.hpp"
#include "daemon/publish/control_server.hpp"
#include "kolsky/v1/kolsky.pb.h"
#include "processing/base/error.hpp"

namespace kolsky {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// Holds up whoever passes until it is opened.
class Gate {
 public:
  void pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
  }
  void wait_for_somebody() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_ > 0; });
  }
  void open() {
    const std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int waiting_ = 0;
};

/// A daemon that counts what it is asked to do.
class CountingHandler : public ControlHandler {
 public:
  std::atomic<int> armed = 0;
  std::atomic<int> others = 0;
  std::atomic<int> statuses = 0;
  Gate* arm_gate = nullptr;
  Gate* get_gate = nullptr;

  void status(v1::Status& status) override {
    ++statuses;
    status.set_state(armed > 0 ? v1::ARMED : v1::DISARMED);
  }
  void snapshot(v1::Snapshot& snapshot) override { snapshot.mutable_last_shot()->set_id("last"); }
  void arm(v1::Preflight& preflight) override {
    preflight.add_checks()->set_name("disk");
    ++armed;
    if (arm_gate != nullptr) {
      arm_gate->pass();
    }
  }
  void disarm() override { ++others; }
  void force_trigger() override {
    throw InputError("force_trigger", "nothing streams in", "start the digitiser");
  }
  void fire() override { throw std::runtime_error("the relay is stuck"); }
  void reload() override { ++others; }
  void stop() override { ++others; }
  void list_shots(std::size_t most, v1::ShotList& shots) override {
    shots.add_shots()->set_id("shot of " + std::to_string(most));
  }
  void get_shot(const std::string& id, v1::ShotAndResult& shot) override {
    if (get_gate != nullptr) {
      get_gate->pass();
    }
    shot.mutable_shot()->set_id(id);
  }
};

ControlServerOptions on_a_free_port() {
  ControlServerOptions options;
  options.endpoint = "tcp://127.0.0.1:*";
  options.boot_id = 1000;
  return options;
}

ControlClient client_of(const std::string& endpoint, const std::string& id = "ann@lab",
                        std::chrono::milliseconds timeout = 3000ms, int attempts = 3) {
  ControlClientOptions options;
  options.endpoint = endpoint;
  options.client_id = id;
  options.timeout = timeout;
  options.attempts = attempts;
  return ControlClient(options);
}

/// Frames to a control server as any program may send them.
class RawPeer {
 public:
  explicit RawPeer(const std::string& endpoint, int wait_ms = 3000)
      : socket_(context_, zmq::socket_type::dealer) {
    socket_.set(zmq::sockopt::rcvtimeo, wait_ms);
    socket_.set(zmq::sockopt::linger, 0);
    socket_.connect(endpoint);
  }
  void send(const std::vector<std::string>& frames) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
      socket_.send(zmq::buffer(frames[i]),
                   i + 1 < frames.size() ? zmq::send_flags::sndmore : zmq::send_flags::none);
    }
  }
  void send(const v1::ControlRequest& request) { send({request.SerializeAsString()}); }
  [[nodiscard]] std::vector<std::string> receive() {
    std::vector<zmq::message_t> frames;
    std::vector<std::string> texts;
    if (zmq::recv_multipart(socket_, std::back_inserter(frames))) {
      for (const zmq::message_t& frame : frames) {
        texts.push_back(frame.to_string());
      }
    }
    return texts;
  }
  [[nodiscard]] v1::ControlReply reply() {
    const std::vector<std::string> frames = receive();
    v1::ControlReply reply;
    EXPECT_EQ(frames.size(), 1U);
    EXPECT_TRUE(!frames.empty() && reply.ParseFromString(frames.back()));
    return reply;
  }
  [[nodiscard]] v1::ControlReply ask(const v1::ControlRequest& request) {
    send(request);
    return reply();
  }

 private:
  zmq::context_t context_;
  zmq::socket_t socket_;
};

v1::ControlRequest request(const std::string& id, const std::string& client = "ann@lab") {
  v1::ControlRequest request;
  request.set_request_id(id);
  request.set_client_id(client);
  request.set_schema_version(1);
  return request;
}

v1::ControlRequest arm_request(const std::string& id, const std::string& client = "ann@lab") {
  v1::ControlRequest arm = request(id, client);
  arm.mutable_arm();
  return arm;
}

v1::ControlRequest status_request(const std::string& id) {
  v1::ControlRequest status = request(id);
  status.mutable_status();
  return status;
}

TEST(Control, EveryCommandReachesTheDaemonAndItsAnswerTheClient) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  ControlClient client = client_of(server.endpoint());
  EXPECT_EQ(client.status().state(), v1::DISARMED);
  EXPECT_EQ(client.arm().checks(0).name(), "disk");
  EXPECT_EQ(client.status().state(), v1::ARMED);
  EXPECT_EQ(client.status().boot_id(), 1000U);
  client.disarm();
  client.reload();
  client.stop();
  EXPECT_EQ(handler.armed, 1);
  EXPECT_EQ(handler.others, 3);
  EXPECT_EQ(client.list_shots(7).shots(0).id(), "shot of 7");
  EXPECT_EQ(client.get_shot("s5").shot().id(), "s5");
  EXPECT_EQ(client.snapshot().last_shot().id(), "last");
}

TEST(Control, ARefusalKeepsItsWordsAndItsParts) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  ControlClient client = client_of(server.endpoint());
  try {
    client.force_trigger();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.place().find("force_trigger"), std::string::npos);
    EXPECT_EQ(error.problem(), "nothing streams in");
    EXPECT_EQ(error.mend(), "start the digitiser");
  }
  v1::ControlRequest fire;
  fire.mutable_fire();
  const v1::ControlReply reply = client.request(fire);
  EXPECT_FALSE(reply.ok());
  EXPECT_EQ(reply.refusal(), v1::NOT_DONE);
  EXPECT_NE(reply.error().find("the relay is stuck"), std::string::npos);
}

TEST(Control, APreflightThatFailsIsShownCheckByCheck) {
  class Unfit : public CountingHandler {
    void arm(v1::Preflight& preflight) override {
      preflight.add_checks()->set_text("12 MB free");
      throw InputError("disk", "12 MB are free", "free 2 GB");
    }
  } handler;
  const ControlServer server(on_a_free_port(), handler);
  ControlClient client = client_of(server.endpoint());
  v1::ControlRequest arm;
  arm.mutable_arm();
  const v1::ControlReply reply = client.request(arm);
  EXPECT_FALSE(reply.ok());
  EXPECT_EQ(reply.preflight().checks(0).text(), "12 MB free");
  EXPECT_EQ(reply.error(), "disk: 12 MB are free; free 2 GB");
  EXPECT_THROW(client.arm(), InputError);
}

TEST(Control, ARepeatedRequestIsAnsweredAgainAndNotCarriedOutAgain) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer first(server.endpoint());
  RawPeer second(server.endpoint());
  const v1::ControlReply original = first.ask(arm_request("1"));
  EXPECT_TRUE(original.ok());
  EXPECT_FALSE(original.repeated_request());
  for (RawPeer* peer : {&first, &second, &first}) {
    const v1::ControlReply again = peer->ask(arm_request("1"));
    EXPECT_TRUE(again.ok());
    EXPECT_TRUE(again.repeated_request());
    EXPECT_EQ(again.request_id(), "1");
    EXPECT_EQ(again.preflight().checks(0).name(), "disk");
  }
  EXPECT_EQ(handler.armed, 1);
  EXPECT_FALSE(first.ask(arm_request("2")).repeated_request());
  EXPECT_EQ(handler.armed, 2);
  EXPECT_FALSE(first.ask(status_request("3")).repeated_request());
  EXPECT_TRUE(first.ask(status_request("3")).repeated_request());
  EXPECT_EQ(handler.statuses, 1);
}

TEST(Control, ARequestRepeatedWhileItIsCarriedOutWaitsForTheFirst) {
  CountingHandler handler;
  Gate gate;
  handler.arm_gate = &gate;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer first(server.endpoint());
  RawPeer second(server.endpoint());
  first.send(arm_request("1"));
  gate.wait_for_somebody();
  second.send(arm_request("1"));
  // Answered in the server's own thread, so the repetition before it has been taken in.
  EXPECT_TRUE(RawPeer(server.endpoint()).ask(status_request("s")).ok());
  std::this_thread::sleep_for(20ms);
  gate.open();
  EXPECT_FALSE(first.reply().repeated_request());
  EXPECT_TRUE(second.reply().repeated_request());
  EXPECT_EQ(handler.armed, 1);
}

TEST(Control, AnImpatientClientArmsOnce) {
  CountingHandler handler;
  Gate gate;
  handler.arm_gate = &gate;
  const ControlServer server(on_a_free_port(), handler);
  ControlClient client = client_of(server.endpoint(), "ann@lab", 60ms, 100);
  std::thread opener([&gate] {
    gate.wait_for_somebody();
    std::this_thread::sleep_for(300ms);
    gate.open();
  });
  v1::ControlRequest arm;
  arm.mutable_arm();
  const v1::ControlReply reply = client.request(arm);
  opener.join();
  EXPECT_TRUE(reply.ok());
  EXPECT_TRUE(reply.repeated_request());
  EXPECT_EQ(handler.armed, 1);
}

/// A network between client and server that swallows some of the replies.
class SwallowingNetwork {
 public:
  SwallowingNetwork(const std::string& server, int swallow)
      : swallow_(swallow),
        front_(context_, zmq::socket_type::router),
        back_(context_, zmq::socket_type::dealer) {
    front_.bind("tcp://127.0.0.1:*");
    back_.connect(server);
    front_.set(zmq::sockopt::linger, 0);
    back_.set(zmq::sockopt::linger, 0);
    endpoint_ = front_.get(zmq::sockopt::last_endpoint);
    thread_ = std::thread([this] { run(); });
  }
  ~SwallowingNetwork() {
    stop_ = true;
    thread_.join();
  }
  SwallowingNetwork(const SwallowingNetwork&) = delete;
  SwallowingNetwork& operator=(const SwallowingNetwork&) = delete;

  [[nodiscard]] const std::string& endpoint() const { return endpoint_; }
  [[nodiscard]] int swallowed() const { return swallowed_; }

 private:
  void run() {
    while (!stop_) {
      zmq::pollitem_t items[] = {{front_.handle(), 0, ZMQ_POLLIN, 0},
                                 {back_.handle(), 0, ZMQ_POLLIN, 0}};
      zmq::poll(items, 2, 20ms);
      if ((items[0].revents & ZMQ_POLLIN) != 0) {
        forward(front_, back_, false);
      }
      if ((items[1].revents & ZMQ_POLLIN) != 0) {
        forward(back_, front_, true);
      }
    }
  }

  void forward(zmq::socket_t& from, zmq::socket_t& to, bool is_reply) {
    std::vector<zmq::message_t> frames;
    static_cast<void>(zmq::recv_multipart(from, std::back_inserter(frames)));
    v1::ControlReply reply;
    const bool of_a_command =
        is_reply && reply.ParseFromString(frames.back().to_string()) && !reply.has_status();
    if (of_a_command && swallowed_ < swallow_) {
      ++swallowed_;
      return;
    }
    zmq::send_multipart(to, frames);
  }

  int swallow_;
  std::atomic<int> swallowed_ = 0;
  std::atomic<bool> stop_ = false;
  zmq::context_t context_;
  zmq::socket_t front_;
  zmq::socket_t back_;
  std::string endpoint_;
  std::thread thread_;
};

TEST(Control, ASwallowedReplyArmsOnce) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  const SwallowingNetwork network(server.endpoint(), 2);
  ControlClient client = client_of(network.endpoint(), "ann@lab", 150ms, 5);
  EXPECT_EQ(client.arm().checks(0).name(), "disk");
  EXPECT_EQ(network.swallowed(), 2);
  EXPECT_EQ(handler.armed, 1);
}

TEST(Control, WhenEveryReplyIsLostTheClientSaysThatNobodyKnows) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  const SwallowingNetwork network(server.endpoint(), 1000);
  ControlClient client = client_of(network.endpoint(), "ann@lab", 100ms, 2);
  try {
    client.arm();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.problem().find("nobody knows"), std::string::npos) << error.what();
  }
  EXPECT_EQ(handler.armed, 1);
}

TEST(Control, AnIdIsNotTakenForTwoCommands) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer peer(server.endpoint());
  EXPECT_TRUE(peer.ask(arm_request("1")).ok());
  v1::ControlRequest disarm = request("1");
  disarm.mutable_disarm();
  EXPECT_EQ(peer.ask(disarm).refusal(), v1::ID_REUSED);
  EXPECT_EQ(handler.others, 0);
  // Another client's ids are its own.
  v1::ControlRequest get = request("1", "ben@office");
  get.mutable_get_shot()->set_id("s");
  EXPECT_TRUE(peer.ask(get).ok());
}

TEST(Lease, AnotherClientsCommandsAreRefusedNamingTheHolder) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  EXPECT_EQ(server.operator_id(), "");
  ControlClient ann = client_of(server.endpoint(), "ann@lab");
  ControlClient ben = client_of(server.endpoint(), "ben@office");
  ann.arm();
  EXPECT_EQ(server.operator_id(), "ann@lab");
  for (const auto command :
       {&ControlClient::disarm, &ControlClient::force_trigger, &ControlClient::fire,
        &ControlClient::reload, &ControlClient::stop, &ControlClient::release}) {
    try {
      (ben.*command)();
      ADD_FAILURE() << "two operators";
    } catch (const InputError& error) {
      EXPECT_NE(error.problem().find("ann@lab"), std::string::npos) << error.what();
    }
  }
  EXPECT_EQ(handler.others, 0);
  EXPECT_THROW(ben.arm(), InputError);
  EXPECT_EQ(handler.armed, 1);
  // Looking needs no lease.
  EXPECT_EQ(ben.status().operator_id(), "ann@lab");
  EXPECT_EQ(ben.get_shot("s").shot().id(), "s");
  EXPECT_EQ(ben.list_shots().shots_size(), 1);

  ann.release();
  EXPECT_EQ(ben.status().operator_id(), "");
  ben.disarm();
  EXPECT_EQ(handler.others, 1);
  EXPECT_EQ(server.operator_id(), "ben@office");
}

TEST(Lease, ASilentHolderLosesItAndOneThatLooksDoesNot) {
  CountingHandler handler;
  ControlServerOptions options = on_a_free_port();
  options.lease = 300ms;
  const ControlServer server(options, handler);
  ControlClient ann = client_of(server.endpoint(), "ann@lab");
  ControlClient ben = client_of(server.endpoint(), "ben@office");
  ann.arm();
  for (int i = 0; i < 10; ++i) {
    std::this_thread::sleep_for(50ms);
    static_cast<void>(ann.status());
  }
  EXPECT_THROW(ben.disarm(), InputError);
  std::this_thread::sleep_for(350ms);
  EXPECT_EQ(server.operator_id(), "");
  ben.disarm();
  EXPECT_THROW(ann.disarm(), InputError);
}

TEST(Lease, AHolderThatWaitsForItsOwnCommandIsNotSilent) {
  CountingHandler handler;
  Gate gate;
  handler.arm_gate = &gate;
  ControlServerOptions options = on_a_free_port();
  options.lease = 100ms;
  const ControlServer server(options, handler);
  RawPeer ann(server.endpoint());
  ann.send(arm_request("1"));
  gate.wait_for_somebody();
  RawPeer ben(server.endpoint());
  for (int i = 0; i < 6; ++i) {
    std::this_thread::sleep_for(50ms);
    const v1::ControlReply refused = ben.ask(arm_request(std::to_string(i), "ben@office"));
    EXPECT_EQ(refused.refusal(), v1::LEASE_HELD) << i;
  }
  gate.open();
  EXPECT_TRUE(ann.reply().ok());
  EXPECT_EQ(handler.armed, 1);
}

struct Malformed {
  const char* what;
  std::vector<std::string> frames;
  const char* named;
  v1::Refusal refusal = v1::MALFORMED;
};

std::string with(const v1::ControlRequest& good, void (*spoil)(v1::ControlRequest&)) {
  v1::ControlRequest spoilt = good;
  spoil(spoilt);
  return spoilt.SerializeAsString();
}

TEST(Control, WrongBytesGetAReplyWithTheMend) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer peer(server.endpoint());
  const v1::ControlRequest good = arm_request("1");
  const std::vector<Malformed> cases = {
      {"garbage", {"\xff\xfe\xfd"}, "ControlRequest"},
      {"text", {"arm\n"}, "ControlRequest"},
      {"nothing", {"", ""}, "schema_version", v1::SCHEMA_VERSION},
      {"two frames", {good.SerializeAsString(), "more"}, "frame"},
      {"many frames", {"a", "b", "c", "d", "e"}, "frame"},
      {"cut short", {good.SerializeAsString().substr(0, 5)}, "ControlRequest"},
      {"a later version",
       {with(good, [](auto& r) { r.set_schema_version(2); })},
       "same age",
       v1::SCHEMA_VERSION},
      {"no version",
       {with(good, [](auto& r) { r.clear_schema_version(); })},
       "schema_version",
       v1::SCHEMA_VERSION},
      {"no id", {with(good, [](auto& r) { r.clear_request_id(); })}, "request_id"},
      {"no client", {with(good, [](auto& r) { r.clear_client_id(); })}, "client_id"},
      {"two lines", {with(good, [](auto& r) { r.set_client_id("a\nb"); })}, "client_id"},
      {"a long id",
       {with(good, [](auto& r) { r.set_request_id(std::string(300, 'x')); })},
       "request_id"},
      {"no command", {with(good, [](auto& r) { r.clear_command(); })}, "command"},
      {"a command of a later version",
       {with(good, [](auto& r) { r.clear_command(); }) + std::string("\xa2\x06\x00", 3)},
       "command"},
      {"70 KB", {std::string(70'000, 'x')}, "too long"},
  };
  for (const Malformed& wrong : cases) {
    peer.send(wrong.frames);
    std::vector<std::string> frames = peer.receive();
    ASSERT_FALSE(frames.empty()) << wrong.what << ": no reply";
    v1::ControlReply reply;
    ASSERT_TRUE(reply.ParseFromString(frames.back())) << wrong.what;
    EXPECT_FALSE(reply.ok()) << wrong.what;
    EXPECT_EQ(reply.refusal(), wrong.refusal) << wrong.what << ": " << reply.error();
    EXPECT_NE(reply.error().find(wrong.named), std::string::npos)
        << wrong.what << ": " << reply.error();
    EXPECT_EQ(reply.error().find('\n'), std::string::npos) << wrong.what;
  }
  EXPECT_EQ(handler.armed, 0);
  EXPECT_TRUE(peer.ask(good).ok());
}

TEST(Control, TwoMegabytesCostTheSenderItsConnectionAndNobodyElse) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer peer(server.endpoint(), 200);
  peer.send({std::string(2 << 20, 'x')});
  EXPECT_TRUE(peer.receive().empty());
  EXPECT_TRUE(RawPeer(server.endpoint()).ask(status_request("1")).ok());
}

TEST(Control, BothFramingsAreAnsweredInKind) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer peer(server.endpoint());
  peer.send({status_request("1").SerializeAsString()});
  EXPECT_EQ(peer.receive().size(), 1U);
  peer.send({"", status_request("2").SerializeAsString()});
  const std::vector<std::string> frames = peer.receive();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0], "");
}

TEST(Control, ASlowGetHoldsUpNeitherStatusNorCommands) {
  CountingHandler handler;
  Gate gate;
  handler.get_gate = &gate;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer reader(server.endpoint());
  v1::ControlRequest get = request("g");
  get.mutable_get_shot()->set_id("s");
  reader.send(get);
  gate.wait_for_somebody();
  ControlClient client = client_of(server.endpoint(), "ann@lab", 2000ms, 1);
  EXPECT_EQ(client.status().state(), v1::DISARMED);
  EXPECT_NO_THROW(client.arm());
  gate.open();
  EXPECT_EQ(reader.reply().shot().shot().id(), "s");
}

TEST(Control, TooManyWaitingAreRefusedAsBusy) {
  CountingHandler handler;
  Gate gate;
  handler.get_gate = &gate;
  ControlServerOptions options = on_a_free_port();
  options.most_waiting = 3;
  const ControlServer server(options, handler);
  RawPeer peer(server.endpoint());
  const auto get = [&peer](const std::string& id) {
    v1::ControlRequest get_request = request(id);
    get_request.mutable_get_shot()->set_id(id);
    peer.send(get_request);
  };
  get("0");
  gate.wait_for_somebody();
  for (int i = 1; i <= 5; ++i) {
    get(std::to_string(i));
  }
  for (const char* id : {"4", "5"}) {
    const v1::ControlReply refused = peer.reply();
    EXPECT_EQ(refused.refusal(), v1::BUSY);
    EXPECT_EQ(refused.request_id(), id);
  }
  gate.open();
  for (const char* id : {"0", "1", "2", "3"}) {
    EXPECT_EQ(peer.reply().shot().shot().id(), id);
  }
}

TEST(Control, ADeadClientHarmsNobody) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  for (int i = 0; i < 50; ++i) {
    RawPeer gone(server.endpoint());
    gone.send(status_request(std::to_string(i)));
  }
  // One that asks and never reads: its replies pile up to a bound and are dropped from there.
  RawPeer deaf(server.endpoint());
  for (int i = 0; i < 5000; ++i) {
    deaf.send(status_request("deaf" + std::to_string(i)));
  }
  ControlClient client = client_of(server.endpoint());
  EXPECT_NO_THROW(client.arm());
}

TEST(Control, TheReplyToStopArrivesAlthoughTheServerEnds) {
  struct Stopping : CountingHandler {
    Gate stopped;
    void stop() override {
      stopped.open();
      std::this_thread::sleep_for(50ms);
    }
  } handler;
  auto server = std::make_unique<ControlServer>(on_a_free_port(), handler);
  ControlClient client = client_of(server->endpoint(), "ann@lab", 2000ms, 1);
  static_cast<void>(client.status());
  std::thread owner([&] {
    handler.stopped.pass();
    server.reset();
  });
  EXPECT_NO_THROW(client.stop());
  owner.join();
}

TEST(Control, WhatWaitsWhenTheServerEndsIsRefusedAndNotCarriedOut) {
  CountingHandler handler;
  Gate gate;
  handler.arm_gate = &gate;
  auto server = std::make_unique<ControlServer>(on_a_free_port(), handler);
  RawPeer peer(server->endpoint());
  peer.send(arm_request("1"));
  gate.wait_for_somebody();
  peer.send(arm_request("2"));
  EXPECT_TRUE(RawPeer(server->endpoint()).ask(status_request("s")).ok());
  std::this_thread::sleep_for(20ms);
  std::thread owner([&server] { server.reset(); });
  std::this_thread::sleep_for(50ms);
  gate.open();
  EXPECT_TRUE(peer.reply().ok());
  EXPECT_EQ(peer.reply().refusal(), v1::STOPPING);
  owner.join();
  EXPECT_EQ(handler.armed, 1);
}

TEST(Control, ACommandForADaemonThatEndedIsRefusedByItsSuccessor) {
  CountingHandler handler;
  const ControlServer server(on_a_free_port(), handler);
  RawPeer peer(server.endpoint());
  v1::ControlRequest arm = arm_request("1");
  arm.set_boot_id(999);
  const v1::ControlReply refused = peer.ask(arm);
  EXPECT_EQ(refused.refusal(), v1::OTHER_BOOT);
  EXPECT_EQ(refused.boot_id(), 1000U);
  EXPECT_EQ(handler.armed, 0);
  EXPECT_EQ(server.operator_id(), "");
  v1::ControlRequest status = status_request("2");
  status.set_boot_id(999);
  EXPECT_TRUE(peer.ask(status).ok());
}

TEST(Control, AClientFollowsARestartedDaemon) {
  CountingHandler first;
  CountingHandler second;
  ControlServerOptions options = on_a_free_port();
  auto server = std::make_unique<ControlServer>(options, first);
  options.endpoint = server->endpoint();
  ControlClient client = client_of(options.endpoint, "ann@lab", 1000ms, 3);
  client.arm();
  server.reset();
  options.boot_id = 2000;
  server = std::make_unique<ControlServer>(options, second);
  // Its socket may still wait to reconnect; a question finds out.
  EXPECT_EQ(client.status().boot_id(), 2000U);
  client.arm();
  EXPECT_EQ(first.armed, 1);
  EXPECT_EQ(second.armed, 1);
}

TEST(Control, AClientWhoseKnowledgeIsOldArmsTheNewDaemonOnce) {
  CountingHandler first;
  CountingHandler second;
  ControlServerOptions options = on_a_free_port();
  auto server = std::make_unique<ControlServer>(options, first);
  options.endpoint = server->endpoint();
  // Long enough for its socket to reconnect within one attempt.
  ControlClient client = client_of(options.endpoint, "ann@lab", 5000ms, 1);
  static_cast<void>(client.status());
  server.reset();
  options.boot_id = 2000;
  server = std::make_unique<ControlServer>(options, second);
  client.arm();
  EXPECT_EQ(first.armed, 0);
  EXPECT_EQ(second.armed, 1);
}

TEST(Control, WithoutADaemonTheClientSaysSoInTime) {
  ControlClient client = client_of("tcp://127.0.0.1:1", "ann@lab", 50ms, 3);
  const auto start = Clock::now();
  try {
    static_cast<void>(client.status());
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.place().find("tcp://127.0.0.1:1"), std::string::npos);
    EXPECT_NE(error.mend().find("start kolskyd"), std::string::npos);
  }
  const auto waited = Clock::now() - start;
  EXPECT_GE(waited, 145ms);
  EXPECT_LT(waited, 3s);
  for (const char* endpoint : {"", "nowhere", "tcp://127.0.0.1", "tcp://127.0.0.1:70000"}) {
    EXPECT_THROW(client_of(endpoint), InputError) << endpoint;
  }
}

TEST(Control, AnAnswerThatIsNoneIsNamed) {
  zmq::context_t context;
  zmq::socket_t impostor(context, zmq::socket_type::rep);
  impostor.bind("tcp://127.0.0.1:*");
  const std::string endpoint = impostor.get(zmq::sockopt::last_endpoint);
  std::thread answering([&impostor] {
    v1::ControlReply other;
    other.set_request_id("of somebody else");
    for (const std::string& answer : {std::string("\xff\xff\xff"), other.SerializeAsString()}) {
      zmq::message_t question;
      static_cast<void>(impostor.recv(question));
      impostor.send(zmq::buffer(answer));
    }
  });
  for (int i = 0; i < 2; ++i) {
    ControlClient client = client_of(endpoint);
    EXPECT_THROW(static_cast<void>(client.status()), InputError);
  }
  answering.join();
}

TEST(Control, TwoServersOnOneEndpointAreRefused) {
  CountingHandler handler;
  const ControlServer first(on_a_free_port(), handler);
  ControlServerOptions options = on_a_free_port();
  options.endpoint = first.endpoint();
  try {
    const ControlServer second(options, handler);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(error.place().find("endpoints.control"), std::string::npos);
  }
}

TEST(Control, TheClientIdSaysWhoAndWhere) {
  const std::string id = default_client_id();
  const std::size_t at = id.find('@');
  ASSERT_NE(at, std::string::npos);
  EXPECT_GT(at, 0U);
  EXPECT_LT(at + 1, id.size());
  EXPECT_EQ(id, default_client_id());
}

}  // namespace
}  // namespace kolsky
